#define THREELINK_ISA avx512
#include "gradient_kernels.inc"
