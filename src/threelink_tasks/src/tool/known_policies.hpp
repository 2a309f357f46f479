// The policies at hand, by what hinge_rates call them.
#pragma once

#include <map>
#include <string>

#include "threelink_agent/policy.hpp"

namespace threelink_tasks {

class KnownPolicies {
 public:
  // Throws threelink_agent::PolicyError if the file is no policy.
  void add_file(const std::string& path) { add(threelink_agent::Policy::load(path)); }
  // The same, of what may be there or not.
  void try_file(const std::string& path);
  void try_folder(const std::string& path);
  void try_bytes(const std::string& bytes);

  // Null if it is not at hand. id: the first 16 digits of its sha256.
  const threelink_agent::Policy* find(const std::string& id) const;

 private:
  void add(const threelink_agent::Policy& policy) { policies_.emplace(policy.id(), policy); }

  std::map<std::string, threelink_agent::Policy> policies_;
};

}  // namespace threelink_tasks
