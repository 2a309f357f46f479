/// @file
/// The BLAS library of LibTorch, which determines most of its speed.
#pragma once

#include <string>

namespace threelink_agent {

/// A BLAS library.
struct Blas {
  std::string library;  ///< path of the loaded shared object
  std::string
      kernels;  ///< instruction set or processor that it was built for; empty if it does not say
  bool slow;    ///< the reference implementation, about six times slower than OpenBLAS

  std::string name() const { return kernels.empty() ? library : library + " (" + kernels + ")"; }
};

/// The BLAS that this process has loaded, found among its shared objects.
Blas blas_in_use();

/// Sets BLAS and LibTorch to one thread for each operation. More are slower for networks of this
/// size, and results would depend on their number.
void use_one_thread_per_operation();

}  // namespace threelink_agent
