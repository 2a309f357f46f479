// The episodes that a recorder hears of: which ones it believes, when they begin and when they end.
#include <algorithm>
#include <cctype>
#include <exception>

#include <fmt/format.h>
#include <ros/console.h>

#include "../core/bag_name.hpp"
#include "recorder.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_tasks {
namespace {

namespace fs = std::filesystem;
namespace topics = threelink_sim::topics;
using namespace std::chrono_literals;
using threelink_msgs::Episode;
using threelink_msgs::Recording;
using threelink_msgs::SwimmerState;

constexpr std::size_t kMaxCandidates = 16;  // start messages that wait for their states
constexpr std::size_t kMostConfig = 1 << 20, kMostText = 4096;  // bytes of an Episode message
constexpr auto kLate = 200ms;  // that the state has which a start message is about

bool starts_with(const Episode& start, const SwimmerState& state) {
  return state.episode == start.episode && state.step == start.step &&
         state.header.stamp == start.header.stamp;
}

// Why an episode is not recorded; empty if it is.
std::string refusal(const Episode& start) {
  const auto is_digit = [](char c) { return std::isxdigit(static_cast<unsigned char>(c)) != 0; };
  const std::string& sha256 = start.policy_sha256;
  if (!is_plain_name(start.task))
    return fmt::format("its task has no name of 1 to {} letters, digits, - and _",
                       kMostNameLetters);
  if (!sha256.empty() &&
      (sha256.size() != 64 || !std::all_of(sha256.begin(), sha256.end(), is_digit)))
    return "its policy_sha256 is not 64 hexadecimal digits";
  if (start.config.size() > kMostConfig || start.reason.size() > kMostText ||
      start.policy_file.size() > kMostText || start.revision.size() > kMostText)
    return fmt::format("its texts are longer than {} bytes (its configuration: {})", kMostText,
                       kMostConfig);
  return "";
}

bool is_end_of(const Episode& end, const Episode& start) {
  return end.episode == start.episode && end.task == start.task && end.seed == start.seed &&
         end.policy_sha256 == start.policy_sha256 && end.step >= start.step &&
         end.header.stamp >= start.header.stamp && end.config.size() <= kMostConfig &&
         end.reason.size() <= kMostText && end.policy_file.size() <= kMostText &&
         end.revision.size() <= kMostText;
}

}  // namespace

void Recorder::on_episode(const Event<Episode>& event) {
  const threelink_msgs::EpisodeConstPtr& message = event.getConstMessage();
  if (message->status == Episode::STARTED) return on_start(event);
  if (open_ && message->episode == open_->episode()) {
    if (event.getPublisherName() == task_ && is_end_of(*message, *last_start_)) {
      open_->expect_end(message);
    } else {
      ++counters_.messages_refused;
    }
    return;
  }
  for (Candidate& candidate : candidates_)
    if (event.getPublisherName() == candidate.publisher && is_end_of(*message, *candidate.start))
      candidate.end = message;
}

void Recorder::on_start(const Event<Episode>& event) {
  const threelink_msgs::EpisodeConstPtr& start = event.getConstMessage();
  const auto is_same = [&](const Episode& other) {
    return other.episode == start->episode && other.header.stamp == start->header.stamp;
  };
  if (last_start_ && is_same(*last_start_)) return;  // a repetition
  if (start->episode == 0) {                         // they count from 1
    ++counters_.messages_refused;
    return;
  }
  candidates_.push_back({start, nullptr, event.getPublisherName(), refusal(*start), Clock::now()});
  if (const std::string& reason = candidates_.back().refusal; !reason.empty()) {
    ++counters_.episodes_refused;
    if (warned_.insert(reason).second) ROS_WARN("an episode is not recorded: %s", reason.c_str());
  }
  if (candidates_.size() > kMaxCandidates) candidates_.pop_front();
  const auto found = std::find_if(early_.begin(), early_.end(), [this](const Early& early) {
    return early.state && is_start(*early.state);
  });
  if (found == early_.end()) return;
  const Early early = *found;  // early_ changes as the episode is opened
  open_with(*early.state, early.publisher);
}

void Recorder::on_abort(const Event<threelink_msgs::EpisodeAbort>& event) {
  const threelink_msgs::EpisodeAbortConstPtr& message = event.getConstMessage();
  if (!open_ || message->episode != open_->episode()) return;
  if (event.getPublisherName() != simulator_) {
    ++counters_.messages_refused;
    return;
  }
  open_->record(node_.resolveName(topics::kAbort), message->header.stamp, message);
  open_->expect_end();  // the task's Episode message should follow
}

bool Recorder::is_start(const SwimmerState& state) const {
  return std::any_of(candidates_.begin(), candidates_.end(), [&](const Candidate& candidate) {
    return starts_with(*candidate.start, state);
  });
}

bool Recorder::open_with(const SwimmerState& state, const std::string& publisher) {
  const auto found = std::find_if(
      candidates_.begin(), candidates_.end(),
      [&](const Candidate& candidate) { return starts_with(*candidate.start, state); });
  if (found == candidates_.end()) return false;
  const Candidate candidate = *found;
  candidates_.erase(found);
  if (candidate.refusal.empty()) {
    open_episode(candidate, publisher);
  } else {
    refuse_episode(candidate);
  }
  return true;
}

void Recorder::join_late() {
  const auto now = Clock::now();
  for (auto candidate = candidates_.rbegin(); candidate != candidates_.rend(); ++candidate) {
    const Episode& start = *candidate->start;
    if (now - candidate->heard < kLate || !candidate->refusal.empty()) continue;
    const auto later = std::find_if(early_.begin(), early_.end(), [&](const Early& early) {
      return early.state && early.state->episode == start.episode &&
             early.state->step > start.step && early.state->header.stamp > start.header.stamp;
    });
    if (later == early_.end()) continue;
    const Candidate chosen = *candidate;
    const std::string publisher = later->publisher;
    candidates_.erase(std::next(candidate).base());
    open_episode(chosen, publisher);
    return;
  }
}

void Recorder::open_episode(const Candidate& candidate, const std::string& simulator) {
  if (open_) close_episode(parameters_.pictures);
  last_start_ = candidate.start;
  task_ = candidate.publisher;
  simulator_ = simulator;
  open_.emplace(parameters_.folder, quota_, node_.resolveName(topics::kEpisode), candidate.start,
                counters_);
  for (const auto& [key, record] : latched_) record(*open_);
  std::deque<Early> early;
  early.swap(early_);
  for (const Early& message : early) {
    if (message.episode.value_or(open_->episode()) == open_->episode()) {
      message.record(*open_);
    } else {
      early_.push_back(message);
    }
  }
  if (candidate.end) open_->expect_end(candidate.end);
}

void Recorder::refuse_episode(const Candidate& candidate) {
  Recording recording;
  recording.header.stamp = candidate.start->header.stamp;
  recording.episode = candidate.start->episode;
  recording.state = Recording::FAILED;
  recording.status =
      fmt::format("episode {} is not recorded: {}", recording.episode, candidate.refusal);
  finished_.push_back({recording, nullptr});
}

void Recorder::close_episode(bool picture) {
  Finished finished;
  finished.recording = open_->close(node_.resolveName(topics::kRecording));
  last_failure_ = open_->failure();
  for (const auto& [stamp, record] : open_->ahead())
    keep_early({record, std::nullopt, nullptr, ""});
  open_.reset();
  if (picture && finished.recording.state == Recording::WRITTEN) {
    const fs::path bag = finished.recording.bag;
    finished.recording.picture = fs::path(bag).replace_extension(".png");
    try {
      finished.drawing = std::make_unique<ChildProcess>(std::vector<std::string>{
          beside_this_program("plot_episode"), bag, "--path", "--out", finished.recording.picture});
    } catch (const std::exception& error) {
      ROS_ERROR("%s", error.what());
      finished.recording.picture.clear();
      finished.recording.status += fmt::format("; {}", error.what());
    }
  }
  finished_.push_back(std::move(finished));
}

}  // namespace threelink_tasks
