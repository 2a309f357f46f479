#define THREELINK_ISA avx512
#include "network_kernels.inc"
