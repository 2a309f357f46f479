#include "recorder.hpp"

#include <algorithm>
#include <exception>
#include <optional>
#include <thread>

#include <fmt/format.h>
#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/poll_manager.h>
#include <sensor_msgs/JointState.h>
#include <threelink_msgs/HingeRates.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/PolicyWeights.h>
#include <threelink_msgs/SwimmerState.h>
#include <threelink_msgs/WorldState.h>
#include <visualization_msgs/MarkerArray.h>

#include "leftover_bag.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_tasks {
namespace {

namespace fs = std::filesystem;
namespace message_size = threelink_sim::message_size;
namespace topics = threelink_sim::topics;
using namespace std::chrono_literals;
using diagnostic_msgs::DiagnosticStatus;
using threelink_msgs::Episode;
using threelink_msgs::Recording;
using threelink_msgs::SwimmerState;

constexpr char kTransforms[] = "/tf";
constexpr char kStaticTransforms[] = "/tf_static";

constexpr std::uint32_t kQueue = 100000;   // messages a topic: some seconds of a slow disk
constexpr std::size_t kMaxEarly = 20000;   // messages that wait for an episode to start
constexpr std::size_t kLoop = 1 << 16;     // [bytes] of a message that comes with each step
constexpr auto kNap = 2ms;                 // between looks at what has arrived
constexpr std::size_t kMaxLatched = 1000;  // messages that are repeated in each bag
constexpr auto kSettled = 100ms;           // connections are up for good after this
constexpr auto kPatience = 1s;             // for the task's last words

template <class Message>
ros::Time stamp_of(const Message& message) {
  return message.header.stamp;
}
ros::Time stamp_of(const tf2_msgs::TFMessage& message) {
  return message.transforms.empty() ? ros::Time() : message.transforms[0].header.stamp;
}

ros::Time stamp_of(const visualization_msgs::MarkerArray& message) {
  return message.markers.empty() ? ros::Time() : message.markers.back().header.stamp;
}

}  // namespace

Recorder::Recorder(const RecorderParameters& parameters)
    : parameters_(parameters),
      quota_(parameters.folder, parameters.quota),
      diagnostics_("recording", "threelink_recorder",
                   [this](threelink_sim::Diagnostics::Status& status, double) { report(status); }),
      counters_(diagnostics_),
      recording_(node_.advertise<Recording>(topics::kRecording, 10, true)) {
  if (const std::string reason = why_not_writable(parameters.folder); !reason.empty())
    refuse_folder(reason);
  recover_leftovers();
  // Waking up for each message takes more of the machine than recording it, and the machine is busy
  // with the loop that is recorded: the network thread naps as run() does.
  ros::PollManager::instance()->addPollThreadListener([] { std::this_thread::sleep_for(kNap); });
  hear<threelink_msgs::SwimmerState>(topics::kState, kLoop, subscribers_,
                                     [this](const auto& event) { on_state(event); });
  listen<geometry_msgs::PointStamped>(topics::kTarget, subscribers_);
  listen<threelink_msgs::Observation>(topics::kObservation, subscribers_);
  listen<threelink_msgs::HingeRates>(topics::kHingeRates, subscribers_);
  listen<sensor_msgs::JointState>(topics::kJointStates, subscribers_);
  listen<geometry_msgs::PoseStamped>(topics::kPose, subscribers_);
  listen<tf2_msgs::TFMessage>(kTransforms, subscribers_);
  listen<threelink_msgs::WorldState>(topics::kWorldState, world_subscribers_);
  hear<Episode>(topics::kEpisode, message_size::kSmall, subscribers_,
                [this](const auto& event) { on_episode(event); });
  hear<threelink_msgs::EpisodeAbort>(topics::kAbort, kLoop, subscribers_,
                                     [this](const auto& event) { on_abort(event); });

  hear<tf2_msgs::TFMessage>(
      kStaticTransforms, message_size::kSmall, latched_subscribers_, [this](const auto& event) {
        const tf2_msgs::TFMessageConstPtr& message = event.getConstMessage();
        if (message->transforms.empty()) return;
        remember(kStaticTransforms, message->transforms[0].child_frame_id, message);
      });
  hear<visualization_msgs::MarkerArray>(
      topics::kWaypoints, message_size::kFile, latched_subscribers_, [this](const auto& event) {
        on_message(node_.resolveName(topics::kWaypoints), event.getConstMessage());
      });
  hear<threelink_msgs::PolicyWeights>(
      topics::kPolicy, message_size::kFile, latched_subscribers_, [this](const auto& event) {
        remember(node_.resolveName(topics::kPolicy), "", event.getConstMessage());
      });
}

int Recorder::run() {
  while (threelink_sim::running()) {
    std::this_thread::sleep_for(kNap);
    ros::getGlobalCallbackQueue()->callAvailable();
    if (!ready_) announce_ready();
    if (!open_) join_late();
    if (open_) open_->tend();
    if (open_ && open_->all_arrived()) close_episode(parameters_.pictures);
    announce_finished();
  }
  end_open_episode();
  return threelink_sim::kSuccess;
}

// --- Incoming messages ---------------------------------------------------------------------------

template <class Message>
void Recorder::hear(const std::string& topic, std::size_t most_bytes,
                    std::vector<ros::Subscriber>& subscribers,
                    const std::function<void(const Event<Message>&)>& heard) {
  subscribers.push_back(threelink_sim::subscribe<Message>(node_, topic, kQueue, most_bytes,
                                                          &diagnostics_, heard, {}));
}

template <class Message>
void Recorder::listen(const std::string& topic, std::vector<ros::Subscriber>& subscribers) {
  const std::string name = node_.resolveName(topic);
  hear<Message>(topic, kLoop, subscribers, [this, name](const Event<Message>& event) {
    on_message(name, event.getConstMessage());
  });
}

void Recorder::keep_early(Early message) {
  early_.push_back(std::move(message));
  if (early_.size() > kMaxEarly) early_.pop_front();
}

// The episode that a message is of; nothing if it is not numbered by episodes.
template <class Message>
std::optional<std::uint32_t> episode_of(const Message& message, decltype(message.episode)*) {
  return message.episode;
}
template <class Message>
std::optional<std::uint32_t> episode_of(const Message&, ...) {
  return std::nullopt;
}

template <class Message>
void Recorder::on_message(const std::string& topic,
                          const boost::shared_ptr<Message const>& message) {
  const ros::Time stamp = stamp_of(*message);
  const std::optional<std::uint32_t> episode = episode_of(*message, nullptr);
  if (open_ && episode.value_or(open_->episode()) == open_->episode())
    return open_->record(topic, stamp, message);
  keep_early(
      {[=](EpisodeRecording& open) { open.record(topic, stamp, message); }, episode, nullptr, ""});
}

void Recorder::on_state(const Event<SwimmerState>& event) {
  const threelink_msgs::SwimmerStateConstPtr& state = event.getConstMessage();
  const std::string topic = node_.resolveName(topics::kState);
  if (open_ && state->episode == open_->episode() && !is_start(*state))
    return open_->record_state(topic, state);
  keep_early({[=](EpisodeRecording& open) { open.record_state(topic, state); }, state->episode,
              state, event.getPublisherName()});
  open_with(*state, event.getPublisherName());
}

template <class Message>
void Recorder::remember(const std::string& topic, const std::string& key,
                        const boost::shared_ptr<Message const>& message) {
  const auto record = [=](EpisodeRecording& open) {
    open.record(topic, open.start(), message, true);
  };
  if (latched_.size() >= kMaxLatched && latched_.count(topic + " " + key) == 0) {
    ++counters_.messages_refused;
    return;
  }
  latched_[topic + " " + key] = record;
  if (open_) record(*open_);
}

// --- The rest ------------------------------------------------------------------------------------

// The task, which waits for this node, is told first: it then refuses to start.
void Recorder::refuse_folder(const std::string& reason) {
  Recording recording;
  recording.state = Recording::FAILED;
  recording.status = fmt::format("~bag_dir = {}: {}", parameters_.folder.string(), reason);
  recording_.publish(recording);
  const auto until = Clock::now() + kPatience;
  while (threelink_sim::running() && recording_.getNumSubscribers() == 0 && Clock::now() < until)
    std::this_thread::sleep_for(kNap);
  std::this_thread::sleep_for(kSettled);
  throw threelink_sim::UsageError(recording.status);
}

void Recorder::recover_leftovers() {
  for (const fs::path& leftover : leftover_bags(parameters_.folder)) {
    try {
      if (const std::optional<IndexRow> row = recover_leftover(leftover))
        ROS_WARN("recovered %lu messages of episode %u, whose recorder died: %s", row->messages,
                 row->episode, (parameters_.folder / row->bag).c_str());
    } catch (const std::exception& error) {
      ROS_ERROR("cannot recover %s: %s", leftover.c_str(), error.what());
    }
  }
}

void Recorder::announce_ready() {
  const auto connected = [](const ros::Subscriber& subscriber) {
    return subscriber.getNumPublishers() > 0;
  };
  const auto is_published = [this](const std::string& topic) {
    ros::master::V_TopicInfo published;
    if (!ros::master::getTopics(published)) return true;  // unknown: asked again
    return std::any_of(published.begin(), published.end(), [&](const ros::master::TopicInfo& info) {
      return info.name == node_.resolveName(topic);
    });
  };
  // A simulator that has a world registers world_state before its other topics; one in still water
  // has none.
  if (!std::all_of(subscribers_.begin(), subscribers_.end(), connected) ||
      (!connected(world_subscribers_.front()) && is_published(topics::kWorldState))) {
    connected_since_.reset();
    return;
  }
  if (!connected_since_) connected_since_ = Clock::now();
  if (Clock::now() - *connected_since_ < kSettled) return;
  ready_ = true;
  Recording recording;
  recording.state = Recording::READY;
  recording.status = "every recorded topic is connected";
  recording_.publish(recording);
}

void Recorder::announce_finished() {
  while (!finished_.empty()) {
    Finished& finished = finished_.front();
    if (finished.drawing) {
      const std::optional<int> status = finished.drawing->poll();
      if (!status) return;
      if (*status != 0) {
        finished.recording.status += fmt::format("; the picture failed (exit status {})", *status);
        finished.recording.picture.clear();
      }
    }
    recording_.publish(finished.recording);
    finished_.pop_front();
  }
}

void Recorder::end_open_episode() {
  // The task ends at the same time, and says so.
  const auto until = Clock::now() + kPatience;
  while (open_ && !open_->all_arrived() && Clock::now() < until)
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  if (open_) close_episode(false);
  for (Finished& finished : finished_) {
    if (finished.drawing) finished.recording.picture.clear();
    finished.drawing.reset();
  }
  announce_finished();
  std::this_thread::sleep_for(kSettled);  // for the announcement to go out
}

void Recorder::report(threelink_sim::Diagnostics::Status& status) {
  const std::string& failure =
      open_ && !open_->failure().empty() ? open_->failure() : last_failure_;
  if (!failure.empty()) {
    status.summary(DiagnosticStatus::ERROR, failure);
  } else {
    status.summary(DiagnosticStatus::OK, open_ ? "recording" : ready_ ? "ready" : "connecting");
  }
  if (open_) status.add("bag", open_->bag());
}

}  // namespace threelink_tasks
