#define THREELINK_ISA avx512
#define THREELINK_ISA_NAME "avx512"
#include "kernels.inc"
