#include "threelink_agent/training/run_folder.hpp"

#include <fmt/format.h>

namespace threelink_agent {
namespace {

std::ofstream create(const std::filesystem::path& path) {
  std::ofstream file(path);
  if (!file) throw RunFolderError(fmt::format("{}: cannot be written", path.string()));
  return file;
}

}  // namespace

RunFolder::RunFolder(const std::filesystem::path& path, const TrainConfig& config) : path_(path) {
  std::error_code error;
  std::filesystem::create_directories(path, error);
  if (error) throw RunFolderError(fmt::format("{}: {}", path.string(), error.message()));
  if (!std::filesystem::is_empty(path))
    throw RunFolderError(
        fmt::format("{}: is not empty; a run needs a folder of its own", path.string()));
  std::ofstream yaml = create(path / "config.yaml");
  yaml << to_yaml(config);
  if (!yaml.flush())
    throw RunFolderError(fmt::format("{}/config.yaml: cannot be written", path.string()));
  metrics_ = create(path / "metrics.csv");
  metrics_
      << "update,episodes,steps,seconds,steps_per_s,mean_return,policy_loss,value_loss,kl,"
         "clip_fraction,entropy,std,actor_learning_rate,critic_learning_rate,speed,efficiency\n";
}

void RunFolder::add(const UpdateReport& report, double seconds, double steps_per_s) {
  const UpdateStatistics& s = report.statistics;
  metrics_ << fmt::format(
                  "{},{},{},{:.3f},{:.0f},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},{:.6g},",
                  report.update, report.episodes, report.steps, seconds, steps_per_s,
                  report.mean_return, s.policy_loss, s.value_loss, s.kl, s.clip_fraction,
                  report.entropy, report.std)
           << fmt::format("{:.6g},{:.6g},", report.rates.actor, report.rates.critic);
  if (report.evaluation)
    metrics_ << fmt::format("{:.7f},{:.7f}\n", report.evaluation->speed,
                            report.evaluation->efficiency);
  else
    metrics_ << ",\n";
  if (!metrics_.flush())
    throw RunFolderError(fmt::format("{}/metrics.csv: cannot be written", path_.string()));
}

void RunFolder::save(const Trainer& trainer) const {
  if (trainer.best()) trainer.best()->save(policy_path().string());
  trainer.policy().save(last_path().string());
}

}  // namespace threelink_agent
