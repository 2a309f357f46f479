#include "threelink_agent/kernel/gradient.hpp"
#include "threelink_sim/isa.hpp"

namespace threelink_agent {

THREELINK_PER_ISA(GradientKernels, kGradientTable);

const GradientKernels& gradient_kernels(threelink_sim::Isa isa) {
  return kGradientTable_per_isa.of(isa);
}

}  // namespace threelink_agent
