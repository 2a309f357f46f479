#include "episode_recording.hpp"

#include <algorithm>
#include <exception>

#include <fmt/format.h>
#include <ros/console.h>

#include "recording_words.hpp"

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
constexpr std::uint64_t kMostLost = 1000000000;  // states at the end, or its step is not believed

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
      messages_refused(diagnostics.refusals("messages refused")),
      episodes_refused(diagnostics.refusals("episodes refused")),
      failures(diagnostics.refusals("bags failed")) {}

EpisodeRecording::EpisodeRecording(const fs::path& folder, const BagQuota& quota,
                                   const std::string& topic,
                                   const threelink_msgs::EpisodeConstPtr& start,
                                   RecordingCounters& counters)
    : folder_(folder),
      quota_(quota),
      counters_(counters),
      episode_topic_(topic),
      start_(start),
      states_(start->step, start->header.stamp) {
  try {
    bag_ = std::make_unique<BagFile>(folder, start->task, start->episode);
    watch_quota();
  } catch (const std::exception& error) {
    fail(error.what(), true);
  }
  constexpr bool kLatched = true;
  write(topic, this->start(), *start, kLatched);
}

// --- What belongs to the episode -----------------------------------------------------------------

void EpisodeRecording::record_state(const std::string& topic, const Pointer<State>& state) {
  last_arrival_ = Clock::now();
  if (state->header.stamp < start()) return;
  state_topic_ = topic;
  const std::uint64_t refused = states_.refused();
  states_.add(*state, [this](const State& taken) { take_state(state_topic_, taken); });
  refused_ += states_.refused() - refused;
  counters_.messages_refused += states_.refused() - refused;
  release_ahead();
}

void EpisodeRecording::take_state(const std::string& topic, const State& state) {
  last_state_arrival_ = last_arrival_;
  const bool aborted = end_ && end_->status == threelink_msgs::Episode::ABORTED;
  // When an episode is aborted, the simulator can be one state ahead of the task.
  if (end_ && state.step > end_->step + aborted) {
    end_.reset();
    announced_.reset();
    ++refused_;
    ++counters_.messages_refused;
  }
  if (!failure_.empty()) ++unwritten_;
  constexpr bool kLatched = true;
  write(topic, state.header.stamp, state, !kLatched);
}

void EpisodeRecording::release_ahead() {
  while (!ahead_.empty() && ahead_.begin()->first <= states_.stamp()) {
    ahead_.begin()->second(*this);
    ahead_.erase(ahead_.begin());
  }
}

void EpisodeRecording::expect_end(const threelink_msgs::EpisodeConstPtr& end) {
  end_ = end;
  expect_end();
}

void EpisodeRecording::expect_end() { announced_ = last_arrival_ = Clock::now(); }

bool EpisodeRecording::all_arrived() const {
  if (!announced_) return false;
  const auto now = Clock::now();
  if (now > std::max(*announced_, last_state_arrival_) + kPatience) return true;
  return end_ && states_.reaches(end_->step) && now - last_arrival_ > kQuiet;
}

void EpisodeRecording::finish_states() {
  std::optional<std::uint64_t> last;
  if (end_ && end_->step - states_.last().value_or(0) < kMostLost) last = end_->step;
  const std::uint64_t refused = states_.refused();
  states_.finish(last, [this](const State& taken) { take_state(state_topic_, taken); });
  refused_ += states_.refused() - refused;
  counters_.messages_refused += states_.refused() - refused;
  counters_.states_missing += states_.missing();
  release_ahead();
  constexpr bool kLatched = true;
  if (end_) write(episode_topic_, end_->header.stamp, *end_, kLatched);
}

std::string EpisodeRecording::losses() const {
  std::string text = states_.missing() == 0
                         ? kNothingMissing
                         : fmt::format("{} states are missing", states_.missing());
  if (refused_ > 0) text += fmt::format("; {} messages of others were left out", refused_);
  return text;
}

// --- The bag -------------------------------------------------------------------------------------

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
  failure_ = fmt::format("episode {} is not recorded{}: {}: {}{}", episode(),
                         broken || !states_.last() ? "" : " to its end", path.string(), reason,
                         disk_report(path));
  broken_ = broken;
  ++counters_.failures;
  ROS_ERROR("%s", failure_.c_str());
}

Recording EpisodeRecording::close(const std::string& topic) {
  Recording recording;
  recording.header.stamp = start();
  recording.episode = episode();
  finish_states();
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
    recording.status = losses();
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
    last.episode = episode();
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
  row.missing = states_.missing() + unwritten_;
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
