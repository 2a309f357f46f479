/// @file
/// Choice of the backend that computes the updates.
#pragma once

#include <memory>
#include <string>

#include "threelink_agent/training/ppo_update.hpp"

namespace threelink_agent {

/// This project's kernels (FusedUpdate), or LibTorch (TorchUpdate).
enum class Backend { kFused, kLibtorch };
std::string to_string(Backend backend);           ///< "fused", "libtorch"
Backend backend_from_string(const std::string&);  ///< throws std::invalid_argument

/// Whether this build has the backend; LibTorch may have been missing.
bool available(Backend backend);

/// The update of a backend. threads: at least 1; the result does not depend on their number. Throws
/// ConfigError, and std::invalid_argument if the backend is not available.
std::unique_ptr<PpoUpdate> make_ppo_update(Backend backend, const TrainConfig& config, int threads);

}  // namespace threelink_agent
