#define THREELINK_ISA baseline
#define THREELINK_ISA_NAME "baseline"
#include "kernels.inc"
