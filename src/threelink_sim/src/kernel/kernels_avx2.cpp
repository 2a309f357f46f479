#define THREELINK_ISA avx2
#define THREELINK_ISA_NAME "avx2"
#include "kernels.inc"
