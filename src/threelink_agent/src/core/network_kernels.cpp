#include "threelink_agent/kernel/network.hpp"
#include "threelink_sim/isa.hpp"

namespace threelink_agent {

THREELINK_PER_ISA(NetworkKernels, kTable);

const NetworkKernels& network_kernels(threelink_sim::Isa isa) { return kTable_per_isa.of(isa); }

}  // namespace threelink_agent
