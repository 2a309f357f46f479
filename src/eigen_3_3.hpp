// Included first in all of this workspace's files where Eigen is 3.4: takes away the iterators over
// vectors that 3.3 lacks, so that what needs them does not compile here either. Eigen declares
// begin() and end() all the same; the types that they return stay incomplete.
#pragma once

#define EIGEN_STLITERATORS_H  // the guard of Eigen's file that defines them

namespace Eigen {
namespace internal {
template <typename>
class pointer_based_stl_iterator;
template <typename>
class generic_randaccess_stl_iterator;
}  // namespace internal
}  // namespace Eigen
