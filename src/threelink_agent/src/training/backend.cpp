#include "threelink_agent/training/backend.hpp"

#include <stdexcept>

#include <fmt/format.h>

#include "threelink_agent/training/fused_update.hpp"
#if defined(THREELINK_LIBTORCH)
#include "threelink_agent/training/torch_update.hpp"
#endif

namespace threelink_agent {

std::string to_string(Backend backend) { return backend == Backend::kFused ? "fused" : "libtorch"; }

Backend backend_from_string(const std::string& name) {
  for (Backend backend : {Backend::kFused, Backend::kLibtorch})
    if (name == to_string(backend)) return backend;
  throw std::invalid_argument(fmt::format("backend \"{}\": must be fused or libtorch", name));
}

bool available([[maybe_unused]] Backend backend) {
#if defined(THREELINK_LIBTORCH)
  return true;
#else
  return backend == Backend::kFused;
#endif
}

std::unique_ptr<PpoUpdate> make_ppo_update(Backend backend, const TrainConfig& config,
                                           int threads) {
  if (backend == Backend::kFused) return std::make_unique<FusedUpdate>(config, threads);
#if defined(THREELINK_LIBTORCH)
  if (backend == Backend::kLibtorch) return std::make_unique<TorchUpdate>(config, threads);
#endif
  throw std::invalid_argument(fmt::format(
      "backend {}: this build does not have it, since LibTorch was missing", to_string(backend)));
}

}  // namespace threelink_agent
