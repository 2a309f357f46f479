#define THREELINK_ISA avx512
#include "world_kernels.inc"
