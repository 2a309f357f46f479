#define THREELINK_ISA avx2
#include "network_kernels.inc"
