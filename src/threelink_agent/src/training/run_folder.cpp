#include "threelink_agent/training/run_folder.hpp"

#include <algorithm>
#include <cctype>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "threelink_agent/safetensors.hpp"
#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/files.hpp"

namespace threelink_agent {
namespace {

namespace fs = std::filesystem;

constexpr char kPrefix[] = "checkpoint_", kSuffix[] = ".safetensors";

std::string checkpoint_name(std::uint32_t update) {
  return fmt::format("{}{:08}{}", kPrefix, update, kSuffix);
}

// The update in the name of a checkpoint; nothing for other names.
std::optional<std::uint32_t> update_of(const std::string& name) {
  std::uint32_t update = 0;
  std::size_t at = std::string(kPrefix).size();
  if (name.compare(0, at, kPrefix) != 0) return {};
  for (; at < name.size() && std::isdigit(static_cast<unsigned char>(name[at])); ++at)
    update = 10 * update + static_cast<std::uint32_t>(name[at] - '0');
  if (name != checkpoint_name(update)) return {};
  return update;
}

std::map<std::uint32_t, fs::path> checkpoints_in(const fs::path& folder) {
  std::map<std::uint32_t, fs::path> found;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (const auto update = update_of(entry.path().filename().string()))
      found[*update] = entry.path();
  return found;
}

// Nothing but what a process leaves that was killed before its run began.
bool is_fresh(const fs::path& folder) {
  return std::all_of(fs::directory_iterator(folder), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) {
                       return entry.path().filename() == RunLock::kFile ||
                              threelink_sim::is_temporary_name(entry.path().filename().string());
                     });
}

// Unless it is there already: a run that has finished needs no room to say so.
void keep(const Policy& policy, const fs::path& path) {
  const bool saved =
      fs::exists(path) &&
      threelink_sim::read_file(path.string(), kMaxContainerBytes) == policy.serialize();
  if (!saved) policy.save(path.string());
}

}  // namespace

RunFolder::RunFolder(const fs::path& path, Opening opening, const TrainConfig& config,
                     const std::string& backend)
    : path_(path), config_(config), backend_(backend) {
  try {
    fs::create_directories(path);
    refuse_strangers(opening);  // before a file is added to them
    lock_ = std::make_unique<RunLock>(path.string());
    refuse_strangers(opening);
  } catch (const fs::filesystem_error& error) {
    throw RunFolderError(fmt::format("{}: {}", path.string(), error.code().message()));
  }
  if (!holds_a_run()) return;
  const TrainConfig begun = load_train_config(config_path().string());
  if (const auto difference = first_difference(config, begun))
    throw RunFolderError(
        fmt::format("{}: {} = {}, but this run has {}; it can only be resumed as it began",
                    path.string(), difference->name, difference->a, difference->b),
        fmt::format("{}: this run has another {}; it can only be resumed as it began",
                    path.string(), difference->name));
  find_checkpoint();
}

void RunFolder::refuse_strangers(Opening opening) const {
  if (is_fresh(path_)) return;
  if (opening == Opening::kNew)
    throw RunFolderError(fmt::format(
        "{}: is not empty; a run needs a folder of its own, or --resume", path_.string()));
  if (!holds_a_run())
    throw RunFolderError(fmt::format("{}: is not empty, and holds no run", path_.string()));
}

void RunFolder::find_checkpoint() {
  const auto found = checkpoints_in(path_);
  for (auto newest = found.rbegin(); newest != found.rend() && !checkpoint_; ++newest) {
    const std::string file = newest->second.string();
    try {
      checkpoint_ =
          parse_checkpoint(threelink_sim::read_file(file, kMaxContainerBytes), file, config_);
    } catch (const CheckpointError& error) {
      warnings_.push_back(error.what());
    } catch (const threelink_sim::FileError& error) {
      warnings_.push_back(error.what());
    }
  }
  if (!checkpoint_ && !found.empty())
    throw RunFolderError(fmt::format("{}: no checkpoint can be used: {}", path_.string(),
                                     fmt::join(warnings_, "; ")),
                         path_.string() + ": no checkpoint can be used");
  if (!checkpoint_ && fs::exists(policy_path()))
    throw RunFolderError(
        fmt::format("{}: holds a policy, but no checkpoint from which to resume", path_.string()));
  if (checkpoint_ && checkpoint_->backend != backend_)
    throw RunFolderError(
        fmt::format("{}: --backend {}, but this run has {}; they differ in the last bits",
                    path_.string(), backend_, threelink_sim::excerpt(checkpoint_->backend)),
        path_.string() + ": this run has another backend");
}

void RunFolder::begin() {
  for (const fs::directory_entry& entry : fs::directory_iterator(path_))
    if (threelink_sim::is_temporary_name(entry.path().filename().string()))
      fs::remove(entry.path());
  if (!holds_a_run()) threelink_sim::write_file(config_path().string(), to_yaml(config_));
  const std::string metrics = metrics_path().string();
  metrics_ = checkpoint_ ? std::make_unique<MetricsFile>(metrics, checkpoint_->metrics_bytes)
                         : std::make_unique<MetricsFile>(metrics);
  if (checkpoint_ && checkpoint_->state.best) keep(checkpoint_->state.best->policy, policy_path());
  writer_ = std::make_unique<CheckpointWriter>([this](const Checkpoint& c) { write(c); });
}

void RunFolder::add(const UpdateReport& report, double seconds, double steps_per_s) {
  metrics_->add(report, seconds, steps_per_s);
  writer_->check();
}

void RunFolder::save(const Trainer& trainer, double seconds) {
  if (metrics_->flushed()) put(trainer, seconds);
}

void RunFolder::finish(const Trainer& trainer, double seconds) {
  metrics_->flush();
  if (newest_ != trainer.state().update) put(trainer, seconds);
  writer_->wait();
  writer_->check();
  keep(trainer.policy(), last_path());
}

void RunFolder::put(const Trainer& trainer, double seconds) {
  writer_->put({config_, backend_, trainer.state(), metrics_->bytes(), seconds});
  newest_ = trainer.state().update;
}

void RunFolder::write(const Checkpoint& checkpoint) {
  metrics_->sync();
  const std::uint32_t update = checkpoint.state.update;
  threelink_sim::write_file((path_ / checkpoint_name(update)).string(), serialize(checkpoint));
  if (checkpoint.state.best) keep(checkpoint.state.best->policy, policy_path());
  // Of this one and its predecessors; there are newer ones only if they are damaged.
  const auto found = checkpoints_in(path_);
  int kept = 0;
  std::error_code ignored;  // the next one tries again
  for (auto it = std::make_reverse_iterator(found.upper_bound(update)); it != found.rend(); ++it)
    if (++kept > kCheckpointsKept) fs::remove(it->second, ignored);
}

}  // namespace threelink_agent
