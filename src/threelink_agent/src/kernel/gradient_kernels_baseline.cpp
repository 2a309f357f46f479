#define THREELINK_ISA baseline
#include "gradient_kernels.inc"
