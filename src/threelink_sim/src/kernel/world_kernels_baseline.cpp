#define THREELINK_ISA baseline
#include "world_kernels.inc"
