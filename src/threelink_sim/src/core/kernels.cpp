#include "threelink_sim/kernel/kernels.hpp"

#include "threelink_sim/isa.hpp"
#include "threelink_sim/kernel/world.hpp"

namespace threelink_sim {

THREELINK_PER_ISA(Kernels, kTable);
THREELINK_PER_ISA(WorldKernels, kWorldTable);

const Kernels& kernels(Isa isa) { return kTable_per_isa.of(isa); }

const Kernels& kernels() {
  static const Kernels& in_use = kernels(isa_in_use());
  return in_use;
}

const WorldKernels& world_kernels(Isa isa) { return kWorldTable_per_isa.of(isa); }

const WorldKernels& world_kernels() {
  static const WorldKernels& in_use = world_kernels(isa_in_use());
  return in_use;
}

}  // namespace threelink_sim
