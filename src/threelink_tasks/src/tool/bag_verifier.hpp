// Proof by replay: whether what a bag says follows, to the bit, from its hinge rates, seed and
// configuration.
//
// State 0 is the task's start. In every state the task gives the target and the outcome, the
// environment the observation, the policy the hinge rates, and these the next state; joint_states,
// pose and the transform to base_link follow from the state. Every field of these messages is
// compared but the sequence number that ROS gives them. What follows from nothing is held to the
// checksums with which the recorder ended the bag. docs/reliability.md has the whole list.
#pragma once

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include <fmt/format.h>

#include "known_policies.hpp"
#include "message_difference.hpp"
#include "recorded_bag.hpp"
#include "threelink_sim/node/simulator_config.hpp"
#include "threelink_tasks/episode.hpp"
#include "threelink_tasks/task.hpp"

namespace threelink_tasks {

constexpr char kTransforms[] = "/tf (base_link)";
constexpr char kNoMessage[] = "no message";
constexpr std::size_t kIdDigits = 16;  // of a sha256, in hinge_rates

struct Difference {
  std::uint64_t step;
  FieldDifference what;  // its field begins with the topic
};

struct Verdict {
  std::map<std::string, std::uint64_t> agreed;  // topic: messages that follow, to the bit
  std::uint64_t actions_proven = 0;             // of the hinge rates that agree, those recomputed
  std::uint64_t watchdog_steps = 0;             // taken with zero rates
  bool targets_proven = true;                   // false: they are taken as recorded
  bool whole = false;                           // its recorder closed the bag
  std::optional<Difference> difference;         // the first
};

class BagVerifier {
 public:
  BagVerifier(RecordedBag bag, const KnownPolicies& policies)
      : bag_(std::move(bag)), policies_(policies) {}

  // To be called once.
  Verdict verify();

 private:
  using Episode = threelink_msgs::Episode;

  // What the Episode message says that ends an episode in a state.
  struct End {
    ros::Time stamp;
    std::uint32_t waypoint = 0;
    EpisodeMeasures measures;
  };

  // Throws Difference.
  [[noreturn]] void differ(const std::string& field, const std::string& recorded,
                           const std::string& replayed) const;
  // Throws Difference unless they are equal but for the sequence number; counts the message.
  template <class Message>
  void compare(const std::string& topic, const Message& recorded, Message replayed);
  // The message of this state; throws Difference if there is none.
  template <class Message>
  const Message& expect(const std::string& topic, Track<Message>& track);
  // The same, null if there is none and the bag may end here.
  template <class Message>
  const Message* expect_answer(const std::string& topic, Track<Message>& track);
  // Compares the messages of this state, any number.
  template <class Message>
  void compare_all(const std::string& topic, Track<Message>& track, const Message& replayed);
  template <class Message>
  void expect_no_more(const std::string& topic, const Track<Message>& track) const;

  void begin();
  void read_config();
  void compare_start();
  void compare_state();
  void compare_world_state();
  // Target, observation and hinge rates of this state; false if the episode ends here.
  bool answer();
  void compare_rates(const threelink_msgs::HingeRates& recorded,
                     const threelink_msgs::Observation& observation);
  // Goes on to the next state. `rates`: null if nobody commanded any.
  void step(const threelink_msgs::HingeRates* rates);
  void compare_end();
  void compare_seal();

  ros::Time stamp() const;  // of this state
  // The past of the first recorded state is not in the bag, and so the task is unknown.
  bool late() const { return first_step_ > 0; }
  // An episode that was broken off may end between any two messages.
  bool may_end_here() const;

  RecordedBag bag_;
  const KnownPolicies& policies_;
  Verdict verdict_;

  Episode start_;
  threelink_sim::SimulatorConfig simulator_;
  std::optional<std::uint64_t> action_seed_;  // of sampled actions
  std::unique_ptr<Task> task_;
  std::optional<threelink_sim::Environment> replay_;

  std::uint64_t first_step_ = 0, step_ = 0;
  ros::Time first_stamp_;
  Eigen::Vector2d first_centroid_;      // [L]
  threelink_msgs::SwimmerState state_;  // this one, as replayed
  Outcome outcome_ = Outcome::kRunning;
  End end_, end_before_;  // as of this state, and the one before
};

// --- Comparing -----------------------------------------------------------------------------------

// ROS counts messages by it; nothing follows from it.
template <class Message>
auto& sequence_number(Message& message) {
  return message.header.seq;
}
inline auto& sequence_number(tf2_msgs::TFMessage& message) {
  return message.transforms[0].header.seq;
}

template <class Message>
void BagVerifier::compare(const std::string& topic, const Message& recorded, Message replayed) {
  Message known = recorded;
  sequence_number(known) = sequence_number(replayed) = 0;
  if (const auto difference = first_difference(known, replayed))
    differ(topic + "." + difference->field, difference->recorded, difference->replayed);
  ++verdict_.agreed[topic];
}

template <class Message>
const Message& BagVerifier::expect(const std::string& topic, Track<Message>& track) {
  if (const Message* message = track.take(stamp())) return *message;
  const Message* other = track.next();
  differ(topic, other ? fmt::format("a message of {:.9f} s", stamp_of(*other).toSec()) : kNoMessage,
         fmt::format("one of {:.9f} s", stamp().toSec()));
}

template <class Message>
const Message* BagVerifier::expect_answer(const std::string& topic, Track<Message>& track) {
  if (may_end_here() && !track.next()) return nullptr;
  return &expect(topic, track);
}

template <class Message>
void BagVerifier::compare_all(const std::string& topic, Track<Message>& track,
                              const Message& replayed) {
  while (const Message* message = track.take(stamp())) compare(topic, *message, replayed);
}

template <class Message>
void BagVerifier::expect_no_more(const std::string& topic, const Track<Message>& track) const {
  if (track.next())
    differ(topic, fmt::format("a message of {:.9f} s", stamp_of(*track.next()).toSec()),
           kNoMessage);
}

}  // namespace threelink_tasks
