/// @file
/// Choice of the instruction set at run time, for any table of kernels.
#pragma once

#include <string>
#include <vector>

namespace threelink_sim {

/// Instruction sets in increasing order of width. avx2 stands for AVX2 with FMA, avx512 for AVX-512
/// F, DQ, BW and VL.
enum class Isa { kBaseline, kAvx2, kAvx512 };

/// "baseline", "avx2" or "avx512".
std::string to_string(Isa isa);

/// All instruction sets of this processor, baseline first.
std::vector<Isa> available_isas();

/// Throws std::invalid_argument if this processor lacks it.
void require(Isa isa);

/// The instruction set in use: the widest available one, unless the environment variable
/// THREELINK_ISA names another. Throws std::invalid_argument if that name is unknown or this
/// processor lacks it.
Isa isa_in_use();

/// One table of kernels, compiled for each instruction set.
template <class Table>
struct PerIsa {
  const Table& baseline;
  const Table& avx2;
  const Table& avx512;

  /// Throws std::invalid_argument if this processor lacks it.
  const Table& of(Isa isa) const {
    require(isa);
    return isa == Isa::kAvx512 ? avx512 : isa == Isa::kAvx2 ? avx2 : baseline;
  }
};

}  // namespace threelink_sim

// Declares the tables `name` that kernel files define, each in the namespace of its instruction
// set, and `name_per_isa`, which holds them. To be used in the enclosing namespace.
#if defined(THREELINK_X86)
#define THREELINK_PER_ISA(Table, name)                      \
  namespace baseline {                                      \
  extern const Table name;                                  \
  }                                                         \
  namespace avx2 {                                          \
  extern const Table name;                                  \
  }                                                         \
  namespace avx512 {                                        \
  extern const Table name;                                  \
  }                                                         \
  constexpr ::threelink_sim::PerIsa<Table> name##_per_isa { \
    baseline::name, avx2::name, avx512::name                \
  }
#else
#define THREELINK_PER_ISA(Table, name)                      \
  namespace baseline {                                      \
  extern const Table name;                                  \
  }                                                         \
  constexpr ::threelink_sim::PerIsa<Table> name##_per_isa { \
    baseline::name, baseline::name, baseline::name          \
  }
#endif
