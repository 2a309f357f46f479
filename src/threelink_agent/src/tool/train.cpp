// rosrun threelink_agent train: trains a policy in this process, without a ROS master.
#include <csignal>
#include <cstdio>
#include <optional>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <malloc.h>

#include "progress.hpp"
#include "threelink_agent/training/blas.hpp"
#include "threelink_agent/training/run_folder.hpp"
#include "threelink_agent/training/trainer.hpp"
#include "threelink_sim/isa.hpp"

namespace {

using namespace threelink_agent;

constexpr int kFailure = 1, kMisuse = 2;

volatile std::sig_atomic_t signal_caught = 0;
void on_signal(int signal) { signal_caught = signal; }

struct Arguments {
  std::string config, out;
  std::optional<std::uint64_t> seed;
  std::optional<std::uint32_t> episodes;
  int threads = 1;
};

void declare(CLI::App& app, Arguments& arguments) {
  app.description(
      "Trains a policy for the swimmer by proximal policy optimisation, without a ROS master.\n"
      "The configuration explains itself (config/train_vfs.yaml); docs/learning.md gives "
      "reasons.\n");
  app.add_option("--config", arguments.config, "YAML file that holds every setting")->required();
  app.add_option("--out", arguments.out,
                 "folder for the run, made if needed; it must be empty. It then holds\n"
                 "policy.safetensors (the best by evaluation), last.safetensors,\n"
                 "metrics.csv (a row an update) and config.yaml (the effective settings)")
      ->required();
  app.add_option("--seed", arguments.seed, "instead of the configuration's seed");
  app.add_option("--episodes", arguments.episodes, "instead of the configuration's episodes");
  app.add_option("--threads", arguments.threads,
                 "actor and critic are updated side by side if there are two; the policy is the\n"
                 "same, to the bit (default 1)")
      ->check(CLI::Range(1, 1024));
  app.footer(
      "The same configuration and seed give the same policy on the same machine.\n"
      "SIGINT and SIGTERM end the training after the present update; both policies are saved.\n"
      "Exit status: 0 trained; 1 failed; 2 wrong arguments or files; 130, 143 after SIGINT, "
      "SIGTERM.");
}

TrainConfig effective_config(const Arguments& arguments) {
  TrainConfig config = load_train_config(arguments.config);
  if (arguments.seed) config.seed = *arguments.seed;
  if (arguments.episodes) config.episodes = *arguments.episodes;
  try {
    config.validate();
  } catch (const ConfigError& error) {
    throw ConfigError(fmt::format("--{}", error.what()));  // seed or episodes: the file is valid
  }
  return config;
}

void print_machine() {
  const Blas blas = blas_in_use();
  fmt::print("BLAS: {}{}\n", blas.library, blas.kernels.empty() ? "" : " (" + blas.kernels + ")");
  if (blas.slow)
    fmt::print(
        "warning: this is the reference BLAS; `apt install libopenblas0-pthread` makes training\n"
        "about six times faster\n");
  fmt::print("own kernels: {}\n", threelink_sim::to_string(threelink_sim::isa_in_use()));
}

// LibTorch makes and drops its tensors by the thousand; without this the larger ones go back to the
// system each time, which costs a fifth of the training.
void keep_freed_memory() {
  mallopt(M_MMAP_THRESHOLD, 64 << 20);
  mallopt(M_TRIM_THRESHOLD, 256 << 20);
}

int train(const Arguments& arguments) {
  const TrainConfig config = effective_config(arguments);
  keep_freed_memory();
  Trainer trainer(config, arguments.threads);
  RunFolder folder(arguments.out, config);
  print_machine();
  fmt::print("training {} episodes of {} steps, seed {}, into {}\n", config.episodes,
             config.environment.steps, config.seed, arguments.out);
  std::fflush(stdout);
  {
    Progress progress(config);
    while (!trainer.finished() && !signal_caught) {
      const UpdateReport report = trainer.update();
      progress.show(report);
      folder.add(report, progress.seconds(), progress.steps_per_s());
      if (report.evaluation) folder.save(trainer);
    }
  }
  if (!trainer.finished()) {
    folder.save(trainer);
    fmt::print("stopped by signal {}; the policies so far are in {}\n", int{signal_caught},
               arguments.out);
    return 128 + signal_caught;
  }
  fmt::print("{} sha256 {}\n", folder.policy_path().string(), trainer.best()->sha256());
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app;
  Arguments arguments;
  declare(app, arguments);
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : kMisuse;
  }
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  try {
    return train(arguments);
  } catch (const ConfigError& error) {
    fmt::print(stderr, "train: {}\n", error.what());
    return kMisuse;
  } catch (const RunFolderError& error) {
    fmt::print(stderr, "train: --out {}\n", error.what());
    return kMisuse;
  } catch (const std::exception& error) {
    fmt::print(stderr, "train: {}\n", error.what());
    return kFailure;
  }
}
