#include "threelink_agent/kernel/gradient.hpp"
#include "threelink_sim/isa.hpp"

namespace threelink_agent {

namespace baseline {
extern const GradientKernels kGradientTable;
}
#if defined(THREELINK_X86)
namespace avx2 {
extern const GradientKernels kGradientTable;
}
namespace avx512 {
extern const GradientKernels kGradientTable;
}
#endif

const GradientKernels& gradient_kernels(threelink_sim::Isa isa) {
  threelink_sim::kernels(isa);  // throws if this processor lacks it
#if defined(THREELINK_X86)
  if (isa == threelink_sim::Isa::kAvx512) return avx512::kGradientTable;
  if (isa == threelink_sim::Isa::kAvx2) return avx2::kGradientTable;
#endif
  return baseline::kGradientTable;
}

}  // namespace threelink_agent
