// rosrun threelink_agent train: trains a policy in this process, without a ROS master.
#include <csignal>
#include <cstdio>
#include <memory>
#include <string>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "run_training.hpp"
#include "terminal.hpp"
#include "threelink_agent/training/backend.hpp"
#include "threelink_agent/training/run_lock.hpp"
#include "threelink_sim/command_line.hpp"
#include "threelink_sim/output.hpp"
#include "threelink_sim/plugins.hpp"

namespace {

using namespace threelink_agent;
using threelink_sim::whole_number;

volatile std::sig_atomic_t signal_caught = 0;
void on_signal(int signal) { signal_caught = signal; }

struct Arguments {
  RunSettings run;
  std::string on_save_error = "stop";
};

void declare(CLI::App& app, Arguments& arguments) {
  app.description(
      "Trains a policy for the swimmer by proximal policy optimisation, without a ROS master.\n"
      "The configuration explains itself (config/train_vfs.yaml); docs/learning.md gives "
      "reasons.\n");
  app.add_option("--config", arguments.run.config,
                 "YAML file that holds every setting; needed unless a run is resumed");
  app.add_option("--out", arguments.run.out,
                 "folder for the run, made if needed; it must be empty, unless with --resume.\n"
                 "It then holds policy.safetensors (the best by evaluation), last.safetensors,\n"
                 "metrics.csv (a row an update), learning_curve.png, config.yaml (the effective\n"
                 "settings) and the last 3 checkpoints")
      ->required();
  app.add_option("--seed", arguments.run.seed, "instead of the configuration's seed")
      ->check(whole_number<std::int64_t>(0));
  app.add_option("--episodes", arguments.run.episodes, "instead of the configuration's episodes")
      ->check(whole_number<std::uint32_t>(1, 100000000));
  app.add_flag("--resume", arguments.run.resume,
               "go on from the newest checkpoint in --out that verifies, to the same bits as\n"
               "without the break; begin if nothing is there yet. The configuration must be the\n"
               "same. So one command can be repeated until it succeeds");
  app.add_option("--backend", arguments.run.backend,
                 "fused: own kernels; libtorch: the same update by autograd (default fused)")
      ->check(CLI::IsMember({to_string(Backend::kFused), to_string(Backend::kLibtorch)}));
  app.add_option("--threads", arguments.run.threads,
                 "of the update; the policy is the same, to the bit (default 1)")
      ->check(whole_number<int>(1, 1024));
  app.add_option("--checkpoint-every", arguments.run.checkpoint_every,
                 "updates from one checkpoint to the next (default 1). They are written in the\n"
                 "background; while the disk is busy with one, a newer one replaces the next")
      ->check(whole_number<std::uint32_t>(1, 100000000));
  app.add_option("--on-save-error", arguments.on_save_error,
                 "stop: end with status 1 if something cannot be written, such as on a full\n"
                 "disk; what was written before stays, and --resume goes on from there.\n"
                 "continue: warn, and try again with the next checkpoint (default stop)")
      ->check(CLI::IsMember({"stop", "continue"}));
  app.add_flag("!--no-plot", arguments.run.plot, "draw no learning_curve.png");
  app.footer(
      "The same configuration and seed give the same policy on the same machine.\n"
      "SIGINT and SIGTERM end the training after the present update; a checkpoint and both\n"
      "policies are saved. After kill -9 or a power cut, --resume goes on from the last\n"
      "checkpoint.\n"
      "A standard output that is closed or full ends no training; the status is then 1.\n"
      "Exit status: 0 trained; 1 failed; 2 wrong arguments or files; 130, 143 after SIGINT, "
      "SIGTERM.");
}

int train(Arguments& arguments) {
  threelink_sim::load_plugins();
  arguments.run.stop_on_save_error = arguments.on_save_error == "stop";
  RunHooks hooks;
  hooks.make_source = [&](const TrainConfig&) {
    return std::make_unique<LocalRollouts>(arguments.run.threads);
  };
  hooks.keep_going = [] { return signal_caught == 0; };
  hooks.on_update = [](const Trainer&, const UpdateReport*, const Progress&) {};
  if (run_training(arguments.run, hooks).finished) return 0;
  say(fmt::format("stopped by signal {}; the policies so far are in {}, and --resume goes on\n",
                  int{signal_caught}, arguments.run.out));
  return 128 + signal_caught;
}

}  // namespace

int main(int argc, char** argv) {
  return threelink_sim::run_tool("train", [=] {
    CLI::App app;
    Arguments arguments;
    declare(app, arguments);
    if (!threelink_sim::parse_command_line(app, argc, argv)) return 0;
    std::signal(SIGINT, on_signal);
    std::signal(SIGTERM, on_signal);
    std::signal(SIGXFSZ, SIG_IGN);  // a limit on file sizes is an error of write(), not the end
    try {
      return train(arguments);
    } catch (const RunFolderError& error) {
      throw RunFolderError(std::string("--out ") + error.what());
    }
  });
}
