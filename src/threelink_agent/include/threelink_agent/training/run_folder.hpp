// Files that a training writes.
#pragma once

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "threelink_agent/training/trainer.hpp"

namespace threelink_agent {

// A folder that cannot be used for a run; what() names it and the reason.
class RunFolderError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

// The folder that a training leaves behind:
//   config.yaml          the effective configuration
//   metrics.csv          a row an update
//   policy.safetensors   the best policy by evaluation
//   last.safetensors     the policy after the last update that was saved
class RunFolder {
 public:
  // Makes the folder if needed and writes config.yaml. Throws RunFolderError if it is not empty
  // or cannot be written.
  RunFolder(const std::filesystem::path& path, const TrainConfig& config);

  // Appends a row to metrics.csv. seconds: wall time since the start; steps_per_s: of this update.
  void add(const UpdateReport& report, double seconds, double steps_per_s);

  // Writes the policies that there are.
  void save(const Trainer& trainer) const;

  std::filesystem::path policy_path() const { return path_ / "policy.safetensors"; }
  std::filesystem::path last_path() const { return path_ / "last.safetensors"; }

 private:
  std::filesystem::path path_;
  std::ofstream metrics_;
};

}  // namespace threelink_agent
