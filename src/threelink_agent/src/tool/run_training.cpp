#include "run_training.hpp"

#include <cstdio>
#include <filesystem>

#include <fmt/format.h>
#include <malloc.h>

#include "learning_curve.hpp"
#include "terminal.hpp"
#include "threelink_agent/training/backend.hpp"
#include "threelink_sim/files.hpp"
#if defined(THREELINK_LIBTORCH)
#include "threelink_agent/training/blas.hpp"
#endif
#include "threelink_agent/training/run_folder.hpp"
#include "threelink_sim/isa.hpp"

namespace threelink_agent {
namespace {

TrainConfig effective_config(const RunSettings& settings) {
  const std::string& prefix = settings.prefix;
  std::string path = settings.config;
  if (path.empty()) {
    const std::filesystem::path begun = std::filesystem::path(settings.out) / "config.yaml";
    if (!settings.resume || !std::filesystem::exists(begun))
      throw ConfigError(
          fmt::format("{}config is required{}", prefix,
                      settings.resume ? ": no run to resume is in " + prefix + "out" : ""));
    path = begun.string();
  }
  TrainConfig config = load_train_config(path);
  if (settings.seed) config.seed = *settings.seed;
  if (settings.episodes) config.episodes = *settings.episodes;
  try {
    config.validate();
  } catch (const ConfigError& error) {
    throw ConfigError(prefix + error.what(),
                      prefix + error.for_peers());  // seed or episodes: the file is valid
  }
  return config;
}

void print_machine(Backend backend) {
  say(fmt::format("backend {}, own kernels: {}\n", to_string(backend),
                  threelink_sim::to_string(threelink_sim::isa_in_use())));
#if defined(THREELINK_LIBTORCH)
  if (backend != Backend::kLibtorch) return;
  const Blas blas = blas_in_use();
  say(fmt::format("BLAS: {}\n", blas.name()));
  if (blas.slow)
    say(fmt::format(
        "warning: this is the reference BLAS; `apt install libopenblas0-pthread` makes this\n"
        "backend about six times faster\n"));
#endif
}

// LibTorch makes and drops its tensors by the thousand; without this the larger ones go back to the
// system each time, which costs a fifth of the training.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
}

Trainer make_trainer(const TrainConfig& config, const RunSettings& settings, Backend backend,
                     std::unique_ptr<RolloutSource> source,
                     const std::optional<Checkpoint>& checkpoint) {
  auto ppo = make_ppo_update(backend, config, settings.threads);
  return checkpoint ? Trainer(config, std::move(ppo), std::move(source), checkpoint->state)
                    : Trainer(config, std::move(ppo), std::move(source));
}

// Until the end, or until somebody ends it.
void train_on(Trainer& trainer, RunFolder& folder, Progress& progress, const RunSettings& settings,
              const RunHooks& hooks) {
  double warned = -1e9;  // [s]
  hooks.on_update(trainer, nullptr, progress);
  while (!trainer.finished() && hooks.keep_going()) {
    UpdateReport report;
    try {
      report = trainer.update();
    } catch (const Interrupted&) {
      return;
    }
    progress.show(report);
    hooks.on_update(trainer, &report, progress);
    try {
      folder.add(report, progress.seconds(), progress.steps_per_s());
    } catch (const threelink_sim::FileError& error) {
      if (settings.stop_on_save_error)
        throw threelink_sim::FileError(
            fmt::format("{}\nstopped; what was written before is untouched, and {}resume goes on "
                        "from it",
                        error.what(), settings.prefix));
      if (progress.seconds() > warned + 30) {
        progress.warn(fmt::format("{}; training goes on", error.what()));
        warned = progress.seconds();
      }
    }
    if (report.update % settings.checkpoint_every == 0) folder.save(trainer, progress.seconds());
  }
}

void print_result(const Trainer& trainer, const RunFolder& folder, double seconds) {
  const TrainConfig& config = trainer.config();
  const Evaluation evaluation = evaluate(*trainer.best(), 0, config.seed);
  say(fmt::format("speed {:.6f}, efficiency {:.4f} %, {} episodes in {}\n", evaluation.speed,
                  100 * evaluation.efficiency, config.episodes, duration(seconds)));
  say(fmt::format("{} sha256 {}\n", folder.policy_path().string(), trainer.best()->sha256()));
}

RunOutcome outcome(const Trainer& trainer, const RunFolder& folder) {
  if (!trainer.best()) return {trainer.finished(), "", ""};
  return {trainer.finished(), folder.policy_path().string(), trainer.best()->sha256()};
}

}  // namespace

RunOutcome run_training(const RunSettings& settings, const RunHooks& hooks) {
  const Backend backend = backend_from_string(settings.backend);
  if (!available(backend))
    throw ConfigError(
        fmt::format("{}backend libtorch: this build does not have it, since LibTorch was missing",
                    settings.prefix));
  const TrainConfig config = effective_config(settings);
  keep_freed_memory();
  const auto opening = settings.resume ? RunFolder::Opening::kResume : RunFolder::Opening::kNew;
  RunFolder folder(settings.out, opening, config, to_string(backend));
  for (const std::string& warning : folder.warnings())
    complain(fmt::format("warning: passed over: {}\n", warning));
  const std::optional<Checkpoint>& checkpoint = folder.checkpoint();
  Trainer trainer = make_trainer(config, settings, backend, hooks.make_source(config), checkpoint);
  folder.begin();
  double seconds = checkpoint ? checkpoint->seconds : 0;
  if (trainer.finished()) {
    folder.finish(trainer, seconds);  // a kill may have come in between
    say(fmt::format("the run in {} had finished\n", settings.out));
    print_result(trainer, folder, seconds);
    return outcome(trainer, folder);
  }

  print_machine(backend);
  const std::uint32_t episodes = trainer.state().update * config.update.episodes;
  say(fmt::format("training {} episodes of {} steps, seed {}, into {}{}\n", config.episodes,
                  config.environment.steps, config.seed, settings.out,
                  episodes > 0 ? fmt::format(", from episode {} on", episodes) : ""));
  std::fflush(stdout);
  {
    Progress progress(config, episodes, seconds);
    try {
      train_on(trainer, folder, progress, settings, hooks);
    } catch (const NoRollout&) {
      folder.finish(trainer, progress.seconds());
      throw;
    }
    seconds = progress.seconds();
    folder.finish(trainer, seconds);
  }
  if (trainer.finished()) {
    if (settings.plot) draw_learning_curve(settings.out);
    print_result(trainer, folder, seconds);
  }
  return outcome(trainer, folder);
}

}  // namespace threelink_agent
