/// @file
/// Choice of what computes the updates.
#pragma once

#include <memory>
#include <string>

#include "threelink_agent/training/ppo_update.hpp"

namespace threelink_agent {

enum class Backend { kFused, kLibtorch };
std::string to_string(Backend backend);           ///< "fused", "libtorch"
Backend backend_from_string(const std::string&);  ///< throws std::invalid_argument

/// Whether this build has it: LibTorch may have been missing.
bool available(Backend backend);

/// Throws ConfigError, and std::invalid_argument if the backend is not available. threads: at least
/// 1; the result does not depend on them.
std::unique_ptr<PpoUpdate> make_ppo_update(Backend backend, const TrainConfig& config, int threads);

}  // namespace threelink_agent
