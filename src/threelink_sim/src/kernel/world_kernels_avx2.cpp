#define THREELINK_ISA avx2
#include "world_kernels.inc"
