#include "threelink_sim/isa.hpp"

#include <algorithm>
#include <cstdlib>
#include <stdexcept>

namespace threelink_sim {

std::string to_string(Isa isa) {
  switch (isa) {
    case Isa::kBaseline:
      return "baseline";
    case Isa::kAvx2:
      return "avx2";
    case Isa::kAvx512:
      return "avx512";
  }
  throw std::invalid_argument("unknown instruction set");
}

std::vector<Isa> available_isas() {
  std::vector<Isa> isas{Isa::kBaseline};
#if defined(THREELINK_X86)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma")) {
    isas.push_back(Isa::kAvx2);
    if (__builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512dq") &&
        __builtin_cpu_supports("avx512bw") && __builtin_cpu_supports("avx512vl"))
      isas.push_back(Isa::kAvx512);
  }
#endif
  return isas;
}

void require(Isa isa) {
  const std::vector<Isa> isas = available_isas();
  if (std::find(isas.begin(), isas.end(), isa) == isas.end())
    throw std::invalid_argument("this processor does not run " + to_string(isa));
}

Isa isa_in_use() {
  static const Isa in_use = [] {
    const std::vector<Isa> isas = available_isas();
    const char* wanted = std::getenv("THREELINK_ISA");
    if (wanted == nullptr || *wanted == '\0') return isas.back();
    std::string names;
    for (Isa isa : isas) {
      if (to_string(isa) == wanted) return isa;
      names += (names.empty() ? "" : ", ") + to_string(isa);
    }
    throw std::invalid_argument("THREELINK_ISA=" + std::string(wanted) + ": this processor runs " +
                                names);
  }();
  return in_use;
}

}  // namespace threelink_sim
