#include "episode_recording.hpp"

#include <exception>

#include <fmt/format.h>
#include <ros/console.h>

namespace threelink_tasks {
namespace {

namespace fs = std::filesystem;
using namespace std::chrono_literals;
using threelink_msgs::Recording;

// An episode is over when nothing came for this long: what is displayed 30 times a second comes
// last.
constexpr auto kQuiet = 60ms;
constexpr auto kPatience = 1s;  // after its end was announced
constexpr auto kQuotaPeriod = 500ms;

// For people: what a file holds and what its disk has left.
std::string disk_report(const fs::path& path) {
  std::error_code unknown;
  const std::uintmax_t size = fs::is_regular_file(path, unknown) ? fs::file_size(path, unknown) : 0;
  const fs::space_info space = fs::space(path, unknown);
  return unknown ? "" : fmt::format(" ({} bytes written, {} free)", size, space.available);
}

}  // namespace

RecordingCounters::RecordingCounters(threelink_sim::Diagnostics& diagnostics)
    : messages(diagnostics.counter("messages recorded")),
      bags(diagnostics.counter("bags written")),
      states_missing(diagnostics.refusals("states missing")),
      failures(diagnostics.refusals("bags failed")) {}

EpisodeRecording::EpisodeRecording(const fs::path& folder, const BagQuota& quota,
                                   const threelink_msgs::Episode& start,
                                   RecordingCounters& counters)
    : folder_(folder),
      quota_(quota),
      counters_(counters),
      episode_(start.episode),
      start_(start.header.stamp) {
  try {
    bag_ = std::make_unique<BagFile>(folder, start.task, start.episode);
    watch_quota();
  } catch (const std::exception& error) {
    fail(error.what(), true);
  }
}

bool EpisodeRecording::is_new(const threelink_msgs::SwimmerState& message) {
  const std::uint64_t expected = last_state_ ? *last_state_ + 1 : 0;
  if (message.step < expected) return false;
  states_missing_ += message.step - expected;
  counters_.states_missing += message.step - expected;
  last_state_ = message.step;
  return true;
}

void EpisodeRecording::expect_end(std::optional<std::uint64_t> last_step) {
  if (last_step) last_step_ = last_step;
  close_until_ = Clock::now() + kPatience;
}

bool EpisodeRecording::all_arrived() const {
  if (!close_until_) return false;
  const auto now = Clock::now();
  if (now > *close_until_) return true;
  return last_step_ && last_state_ >= last_step_ && now - last_arrival_ > kQuiet;
}

void EpisodeRecording::tend() {
  if (!failure_.empty()) return;
  try {
    bag_->flush_if_due();
    if (Clock::now() - quota_watched_ > kQuotaPeriod) watch_quota();
  } catch (const std::exception& error) {
    fail(error.what(), true);
  }
}

void EpisodeRecording::watch_quota() {
  quota_watched_ = Clock::now();
  try {
    quota_.make_room_for(bag_->active_path());
  } catch (const std::exception& error) {  // no room, or an old bag that cannot be deleted
    fail(error.what(), false);
  }
}

void EpisodeRecording::fail(const std::string& reason, bool broken) {
  const fs::path path = bag_ ? bag_->active_path() : folder_;
  failure_ = fmt::format("episode {} is not recorded{}: {}: {}{}", episode_,
                         broken || !last_state_ ? "" : " to its end", path.string(), reason,
                         disk_report(path));
  broken_ = broken;
  ++counters_.failures;
  ROS_ERROR("%s", failure_.c_str());
}

Recording EpisodeRecording::close(const std::string& topic) {
  Recording recording;
  recording.header.stamp = start_;
  recording.episode = episode_;
  if (!broken_) {
    try {
      close_bag(topic, recording);
    } catch (const std::exception& error) {
      fail(error.what(), true);
    }
  }
  if (!failure_.empty()) {
    recording.state = Recording::FAILED;
    recording.status = failure_;
  } else {
    ++counters_.bags;
    recording.state = Recording::WRITTEN;
    recording.status = states_missing_ == 0 ? "no state is missing"
                                            : fmt::format("{} states are missing", states_missing_);
  }
  return recording;
}

void EpisodeRecording::close_bag(const std::string& topic, Recording& recording) {
  if (bag_->contents().messages() == 0) {  // it failed before
    bag_->close();
    fs::remove(bag_->active_path());
    return;
  }
  if (failure_.empty()) {
    Recording last;
    last.header.stamp = bag_->contents().last();
    last.episode = episode_;
    last.state = Recording::WRITTEN;
    last.messages = bag_->contents().messages() + 1;
    last.contents = bag_->contents().text();
    bag_->write_latched(topic, last.header.stamp, last);
    recording.contents = last.contents;
  }
  bag_->close();
  IndexRow row = story_.row();
  row.bag = bag_->path().filename();
  row.messages = recording.messages = bag_->contents().messages();
  append_to_index(folder_, row);
  bag_->rename();
  recording.bag = bag_->path();
  try {
    quota_.rotate();
  } catch (const fs::filesystem_error& error) {
    ROS_ERROR("%s", error.what());
  }
}

}  // namespace threelink_tasks
