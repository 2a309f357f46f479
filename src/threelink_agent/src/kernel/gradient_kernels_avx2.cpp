#define THREELINK_ISA avx2
#include "gradient_kernels.inc"
