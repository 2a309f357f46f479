// The backends of the update that this build has.
#pragma once

#include <vector>

#include "threelink_agent/training/backend.hpp"

namespace threelink_tests {

inline std::vector<threelink_agent::Backend> available_backends() {
  std::vector<threelink_agent::Backend> found;
  for (auto backend : {threelink_agent::Backend::kFused, threelink_agent::Backend::kLibtorch})
    if (threelink_agent::available(backend)) found.push_back(backend);
  return found;
}

}  // namespace threelink_tests
