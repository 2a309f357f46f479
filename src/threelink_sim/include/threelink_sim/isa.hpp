// Choice of the instruction set at run time.
#pragma once

#include <string>
#include <vector>

#include "threelink_sim/kernel/kernels.hpp"

namespace threelink_sim {

// In rising order of width. avx2 stands for AVX2 with FMA, avx512 for AVX-512 F, DQ, BW and VL.
enum class Isa { kBaseline, kAvx2, kAvx512 };

// "baseline", "avx2" or "avx512".
std::string to_string(Isa isa);

// Every instruction set that this processor runs, baseline first.
std::vector<Isa> available_isas();

// The one in use: the widest available, unless the environment variable THREELINK_ISA names
// another. Throws std::invalid_argument if that name is unknown or this processor lacks it.
Isa isa_in_use();

// The kernels of an instruction set. Throws std::invalid_argument if this processor lacks it.
const Kernels& kernels(Isa isa);

// The kernels in use.
const Kernels& kernels();

}  // namespace threelink_sim
