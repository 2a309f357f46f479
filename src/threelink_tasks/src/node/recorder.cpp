#include "recorder.hpp"

#include <algorithm>
#include <exception>
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

#include "leftover_bag.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_tasks {
namespace {

namespace fs = std::filesystem;
namespace topics = threelink_sim::topics;
using namespace std::chrono_literals;
using diagnostic_msgs::DiagnosticStatus;
using threelink_msgs::Episode;
using threelink_msgs::Recording;

constexpr char kTransforms[] = "/tf";
constexpr char kStaticTransforms[] = "/tf_static";

constexpr std::uint32_t kQueue = 100000;  // messages a topic: some seconds of a slow disk
constexpr std::size_t kMaxEarly = 10000;  // messages that wait for an episode to start
constexpr auto kNap = 2ms;                // between looks at what has arrived
constexpr auto kSettled = 100ms;          // connections are up for good after this
// An episode is over when nothing came for this long: what is displayed 30 times a second comes
// last.
constexpr auto kQuiet = 60ms;
constexpr auto kPatience = 1s;  // after its end was announced

template <class Message>
ros::Time stamp_of(const Message& message) {
  return message.header.stamp;
}
ros::Time stamp_of(const tf2_msgs::TFMessage& message) {
  return message.transforms.empty() ? ros::Time() : message.transforms[0].header.stamp;
}

}  // namespace

Recorder::Recorder(const RecorderParameters& parameters)
    : parameters_(parameters),
      diagnostics_("recording", "threelink_recorder",
                   [this](threelink_sim::Diagnostics::Status& status, double) { report(status); }),
      messages_(diagnostics_.counter("messages recorded")),
      bags_(diagnostics_.counter("bags written")),
      states_missing_(diagnostics_.refusals("states missing")),
      failures_(diagnostics_.refusals("bags failed")),
      recording_(node_.advertise<Recording>(topics::kRecording, 10, true)) {
  recover_leftovers();
  // Waking up for each message takes more of the machine than recording it, and the machine is busy
  // with the loop that is recorded: the network thread naps as run() does.
  ros::PollManager::instance()->addPollThreadListener([] { std::this_thread::sleep_for(kNap); });
  listen<threelink_msgs::SwimmerState>(topics::kState);
  listen<geometry_msgs::PointStamped>(topics::kTarget);
  listen<threelink_msgs::Observation>(topics::kObservation);
  listen<threelink_msgs::HingeRates>(topics::kHingeRates);
  listen<sensor_msgs::JointState>(topics::kJointStates);
  listen<geometry_msgs::PoseStamped>(topics::kPose);
  listen<tf2_msgs::TFMessage>(kTransforms);
  subscribers_.push_back(node_.subscribe(topics::kEpisode, kQueue, &Recorder::on_episode, this));
  subscribers_.push_back(node_.subscribe(topics::kAbort, kQueue, &Recorder::on_abort, this));
  static_transform_subscriber_ =
      node_.subscribe(kStaticTransforms, kQueue, &Recorder::on_static_transforms, this);
}

int Recorder::run() {
  while (threelink_sim::running()) {
    std::this_thread::sleep_for(kNap);
    ros::getGlobalCallbackQueue()->callAvailable();
    if (!ready_) announce_ready();
    if (open_ && open_->bag && open_->failure.empty()) {
      try {
        open_->bag->flush_if_due();
      } catch (const std::exception& error) {
        fail(error.what());
      }
    }
    if (open_ && all_arrived()) close_episode(parameters_.pictures);
    announce_finished();
  }
  end_open_episode();
  return threelink_sim::kSuccess;
}

// --- Incoming messages ---------------------------------------------------------------------------

template <class Message>
void Recorder::listen(const std::string& topic) {
  const std::string name = node_.resolveName(topic);
  const boost::function<void(const boost::shared_ptr<Message const>&)> callback =
      [this, name](const boost::shared_ptr<Message const>& message) { on_message(name, message); };
  subscribers_.push_back(node_.subscribe<Message>(topic, kQueue, callback));
}

template <class Message>
void Recorder::on_message(const std::string& topic,
                          const boost::shared_ptr<Message const>& message) {
  last_arrival_ = Clock::now();
  const ros::Time stamp = stamp_of(*message);
  if (open_) return record(topic, stamp, *message);
  early_.push_back({stamp, [this, topic, stamp, message] { record(topic, stamp, *message); }});
  if (early_.size() > kMaxEarly) early_.pop_front();
}

void Recorder::on_static_transforms(const tf2_msgs::TFMessageConstPtr& message) {
  static_transforms_.push_back(message);
}

void Recorder::on_episode(const threelink_msgs::EpisodeConstPtr& message) {
  if (message->status == Episode::STARTED) {
    if (message->header.stamp <= last_start_) return;  // a repetition
    if (open_) close_episode(parameters_.pictures);
    open_episode(*message);
    return;
  }
  if (!open_ || message->episode != open_->number) return;
  record(node_.resolveName(topics::kEpisode), message->header.stamp, *message, true);
  expect_end(message->step);
}

void Recorder::on_abort(const threelink_msgs::EpisodeAbortConstPtr& message) {
  if (!open_ || message->episode != open_->number) return;
  record(node_.resolveName(topics::kAbort), message->header.stamp, *message);
  open_->close_until = Clock::now() + kPatience;  // the task's Episode message should follow
}

// --- The open episode ----------------------------------------------------------------------------

void Recorder::open_episode(const threelink_msgs::Episode& message) {
  last_start_ = message.header.stamp;
  open_.emplace();
  open_->number = message.episode;
  open_->start = message.header.stamp;
  try {
    open_->bag = std::make_unique<BagFile>(parameters_.folder, message.task, message.episode);
  } catch (const std::exception& error) {
    fail(error.what());
  }
  record(node_.resolveName(topics::kEpisode), open_->start, message, true);
  for (const tf2_msgs::TFMessageConstPtr& transforms : static_transforms_)
    record(kStaticTransforms, open_->start, *transforms, true);
  for (const Early& early : early_) early.record();
  early_.clear();
}

template <class Message>
void Recorder::record(const std::string& topic, const ros::Time& stamp, const Message& message,
                      bool latched) {
  if (stamp < open_->start || !is_new(message)) return;
  open_->story.hear(message);
  if (!open_->failure.empty()) return;
  try {
    if (latched) {
      open_->bag->write_latched(topic, stamp, message);
    } else {
      open_->bag->write(topic, stamp, message);
    }
    ++messages_;
  } catch (const std::exception& error) {
    fail(error.what());
  }
}

bool Recorder::is_new(const threelink_msgs::SwimmerState& message) {
  const std::uint64_t expected = open_->last_state ? *open_->last_state + 1 : 0;
  if (message.step < expected) return false;
  open_->states_missing += message.step - expected;
  states_missing_ += message.step - expected;
  open_->last_state = message.step;
  return true;
}

void Recorder::fail(const std::string& reason) {
  const std::string name = open_->bag ? open_->bag->path().string() + kActiveSuffix
                                      : "a new bag in " + parameters_.folder.string();
  open_->failure = fmt::format("episode {} is not recorded: {}: {}", open_->number, name, reason);
  ++failures_;
  ROS_ERROR("%s", open_->failure.c_str());
}

void Recorder::expect_end(std::uint64_t last_step) {
  open_->last_step = last_step;
  open_->close_until = Clock::now() + kPatience;
}

bool Recorder::all_arrived() const {
  if (!open_->close_until) return false;
  const auto now = Clock::now();
  if (now > *open_->close_until) return true;
  return open_->last_step && open_->last_state >= open_->last_step && now - last_arrival_ > kQuiet;
}

void Recorder::close_episode(bool picture) {
  if (open_->failure.empty()) {
    try {
      open_->bag->close();
      ++bags_;
    } catch (const std::exception& error) {
      fail(error.what());
    }
  }
  last_failure_ = open_->failure;
  Finished finished;
  Recording& recording = finished.recording;
  recording.header.stamp = open_->start;
  recording.episode = open_->number;
  if (!open_->failure.empty()) {
    recording.state = Recording::FAILED;
    recording.status = open_->failure;
  } else {
    const fs::path path = open_->bag->path();
    recording.state = Recording::WRITTEN;
    recording.bag = path;
    recording.messages = open_->bag->messages();
    recording.status = open_->states_missing == 0
                           ? "no state is missing"
                           : fmt::format("{} states are missing", open_->states_missing);
    try {
      IndexRow row = open_->story.row();
      row.bag = path.filename();
      row.messages = recording.messages;
      append_to_index(parameters_.folder, row);
      if (picture) {
        recording.picture = fs::path(path).replace_extension(".png");
        finished.drawing = std::make_unique<ChildProcess>(std::vector<std::string>{
            beside_this_program("draw_episode.py"), path, recording.picture});
      }
    } catch (const std::exception& error) {
      ROS_ERROR("%s", error.what());
      recording.status += fmt::format("; {}", error.what());
    }
  }
  finished_.push_back(std::move(finished));
  open_.reset();
}

// --- The rest ------------------------------------------------------------------------------------

void Recorder::recover_leftovers() {
  for (const fs::path& leftover : leftover_bags(parameters_.folder)) {
    try {
      if (fs::is_empty(leftover)) {  // its recorder died before the first message
        fs::remove(leftover);
        continue;
      }
      const IndexRow row = recover_leftover(leftover);
      append_to_index(parameters_.folder, row);
      ROS_WARN("recovered %lu messages of episode %u, whose recorder died: %s", row.messages,
               row.episode, (parameters_.folder / row.bag).c_str());
    } catch (const std::exception& error) {
      ROS_ERROR("cannot recover %s: %s", leftover.c_str(), error.what());
    }
  }
}

void Recorder::announce_ready() {
  const auto connected = [](const ros::Subscriber& subscriber) {
    return subscriber.getNumPublishers() > 0;
  };
  if (!std::all_of(subscribers_.begin(), subscribers_.end(), connected)) {
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
  while (open_ && !all_arrived() && Clock::now() < until)
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
  if (!last_failure_.empty()) {
    status.summary(DiagnosticStatus::ERROR, last_failure_);
  } else {
    status.summary(DiagnosticStatus::OK, open_ ? "recording" : ready_ ? "ready" : "connecting");
  }
  if (open_ && open_->bag) status.add("bag", open_->bag->path().string());
}

}  // namespace threelink_tasks
