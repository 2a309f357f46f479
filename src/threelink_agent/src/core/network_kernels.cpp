#include "threelink_agent/kernel/network.hpp"
#include "threelink_sim/isa.hpp"

namespace threelink_agent {

namespace baseline {
extern const NetworkKernels kTable;
}
#if defined(THREELINK_X86)
namespace avx2 {
extern const NetworkKernels kTable;
}
namespace avx512 {
extern const NetworkKernels kTable;
}
#endif

const NetworkKernels& network_kernels(threelink_sim::Isa isa) {
  threelink_sim::kernels(isa);  // throws if this processor lacks it
#if defined(THREELINK_X86)
  if (isa == threelink_sim::Isa::kAvx512) return avx512::kTable;
  if (isa == threelink_sim::Isa::kAvx2) return avx2::kTable;
#endif
  return baseline::kTable;
}

}  // namespace threelink_agent
