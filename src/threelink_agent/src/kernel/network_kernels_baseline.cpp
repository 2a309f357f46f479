#define THREELINK_ISA baseline
#include "network_kernels.inc"
