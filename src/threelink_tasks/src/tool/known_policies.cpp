#include "known_policies.hpp"

#include <filesystem>

namespace threelink_tasks {

namespace fs = std::filesystem;
using threelink_agent::Policy;
using threelink_agent::PolicyError;

void KnownPolicies::try_file(const std::string& path) {
  try {
    add_file(path);
  } catch (const PolicyError&) {
  }
}

void KnownPolicies::try_folder(const std::string& path) {
  std::error_code unreadable;
  for (const fs::directory_entry& entry : fs::directory_iterator(path, unreadable))
    if (entry.path().extension() == ".safetensors") try_file(entry.path());
}

void KnownPolicies::try_bytes(const std::string& bytes) {
  try {
    add(Policy::parse(bytes, "the bag"));
  } catch (const PolicyError&) {
  }
}

const Policy* KnownPolicies::find(const std::string& id) const {
  const auto policy = policies_.find(id);
  return policy == policies_.end() ? nullptr : &policy->second;
}

}  // namespace threelink_tasks
