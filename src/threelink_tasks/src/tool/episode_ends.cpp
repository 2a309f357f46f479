// The ends of an episode: what is known before it, and what is left after it.
#include <yaml-cpp/yaml.h>

#include "../core/play.hpp"
#include "bag_verifier.hpp"
#include "threelink_agent/evaluate.hpp"
#include "threelink_sim/node/topics.hpp"
#include "threelink_sim/yaml.hpp"
#include "threelink_tasks/task_factory.hpp"

namespace threelink_tasks {
namespace {

namespace topics = threelink_sim::topics;
namespace frames = threelink_sim::frames;
using threelink_msgs::Episode;

std::uint8_t status_of(Outcome outcome) {
  return outcome == Outcome::kCaptured   ? Episode::CAPTURED
         : outcome == Outcome::kTimedOut ? Episode::TIMED_OUT
                                         : Episode::ABORTED;
}

}  // namespace

void BagVerifier::begin() {
  const Episode* start = bag_.episodes.first();
  if (!start) differ(topics::kEpisode, kNoMessage, "the one that starts the episode");
  const Episode* end = bag_.episodes.last();
  if (end->config != start->config) {
    const FieldDifference difference = first_differing_line(end->config, start->config);
    differ("episode.config." + difference.field + " at the end and at the start",
           difference.recorded, difference.replayed);
  }
  start_ = *start;
  bag_.episodes.take(start_.header.stamp);
  read_config();

  const threelink_msgs::SwimmerState* first = bag_.states.first();
  if (!first) differ(topics::kState, kNoMessage, "one");
  first_step_ = step_ = first->step;
  first_stamp_ = first->header.stamp;
  const threelink_sim::Model& model = simulator_.environment.model;
  threelink_sim::SwimmerState state;
  if (late()) {
    verdict_.targets_proven = false;
    if (first->theta.size() != static_cast<std::size_t>(model.links) ||
        first->alpha.size() != static_cast<std::size_t>(model.hinges()))
      differ("state.theta", fmt::format("{} values", first->theta.size()),
             fmt::format("{} values", model.links));
    state.centroid = {first->centroid[0], first->centroid[1]};
    state.heading = first->theta[model.heading_link()];
    state.alpha = threelink_sim::HingeVector::Map(first->alpha.data(), model.hinges());
    bag_.targets.skip_before(first_stamp_);
    bag_.observations.skip_before(first_stamp_);
    bag_.rates.skip_before(first_stamp_);
    bag_.world_states.skip_before(first_stamp_);
    bag_.joint_states.skip_before(first_stamp_);
    bag_.poses.skip_before(first_stamp_);
    bag_.transforms.skip_before(first_stamp_);
  } else {
    state = start_state(simulator_.environment, task_->start(), start_.seed, start_.episode);
  }
  try {
    // Of a late recording the swimmer's past is not known, but its noise and the flow's time are.
    const threelink_sim::EpisodeKey key{start_.seed, start_.episode};
    late() ? replay_->resume(0, state, key, static_cast<std::uint32_t>(first_step_))
           : replay_->reset(0, state, key);
  } catch (const std::invalid_argument& error) {
    differ(topics::kState, error.what(), "one within its limits");
  }
  first_centroid_ = state.centroid;
  task_->reset(start_.seed, start_.episode);
}

void BagVerifier::read_config() {
  try {
    const YAML::Node config = threelink_sim::parse_yaml(start_.config);
    task_ = make_task(config);
    if (task_->takes_points()) verdict_.targets_proven = false;
    threelink_sim::ParameterMap simulator("simulator", config["simulator"]);
    simulator_ = threelink_sim::read_simulator_config(simulator);
    replay_.emplace(simulator_.environment, 1);
    const YAML::Node agent = config["agent"];
    if (agent && agent["sampled"].as<bool>()) action_seed_ = agent["seed"].as<std::uint64_t>();
  } catch (const std::exception& error) {  // of YAML, of a parameter
    differ("episode.config", error.what(), "a configuration");
  }
}

void BagVerifier::compare_start() {
  Episode start = start_;
  start.header.stamp = first_stamp_;
  start.header.frame_id = frames::kWorld;
  start.status = Episode::STARTED;
  start.step = 0;
  start.waypoint = end_.waypoint;
  start.time = start.mean_speed = 0;
  start.reason.clear();
  start.distance = end_.measures.distance;
  const YAML::Node task = threelink_sim::parse_yaml(start_.config)["task"];
  double v_m = 0;
  try {
    start.task = task["name"].as<std::string>();
    start.seed = task["seed"].as<std::uint64_t>();
    start.policy_file = task["policy"].as<std::string>();
    v_m = task["v_m"].as<double>();
  } catch (const YAML::Exception& error) {
    differ("episode.config.task", error.what(), "name, seed, policy and v_m");
  }
  if (const auto* policy = policies_.find(start_.policy_sha256.substr(0, kIdDigits))) {
    start.policy_sha256 = policy->sha256();
    const double speed = threelink_agent::evaluate(*policy, 0, 0).speed;
    if (v_m != speed)
      differ("episode.config.task.v_m", task["v_m"].as<std::string>(),
             fmt::format("{:.17g}", speed));
  }
  compare(topics::kEpisode, start_, start);
}

void BagVerifier::compare_end() {
  const threelink_msgs::EpisodeAbort* abort = bag_.aborts.next();
  const Episode* recorded = bag_.episodes.next();
  if (!recorded) differ(topics::kEpisode, kNoMessage, "the one that ends the episode");
  Episode end = start_;
  // When an episode is aborted, the simulator can be one state ahead of the task.
  const bool ahead = outcome_ == Outcome::kRunning && recorded->step + 1 == step_;
  const End& last = ahead ? end_before_ : end_;
  end.header.stamp = last.stamp;
  end.step = last.measures.steps;
  end.status = status_of(outcome_);
  if (outcome_ == Outcome::kRunning) end.reason = abort ? abort->reason : recorded->reason;
  end.waypoint = last.waypoint;
  end.distance = last.measures.distance;
  end.time = last.measures.time;
  end.mean_speed = last.measures.mean_speed;
  if (!late()) compare(topics::kEpisode, *recorded, end);
  bag_.episodes.take(recorded->header.stamp);

  if (abort) {
    threelink_msgs::EpisodeAbort replayed = *abort;
    replayed.header.stamp = state_.header.stamp;
    replayed.header.frame_id.clear();
    replayed.episode = start_.episode;
    replayed.step = step_;
    compare(topics::kAbort, *abort, replayed);
    bag_.aborts.take(abort->header.stamp);
  }
  expect_no_more(topics::kEpisode, bag_.episodes);
  expect_no_more(topics::kState, bag_.states);
  expect_no_more(topics::kTarget, bag_.targets);
  expect_no_more(topics::kObservation, bag_.observations);
  expect_no_more(topics::kHingeRates, bag_.rates);
  expect_no_more(topics::kAbort, bag_.aborts);
  expect_no_more(topics::kWorldState, bag_.world_states);
  expect_no_more(topics::kJointStates, bag_.joint_states);
  expect_no_more(topics::kPose, bag_.poses);
  expect_no_more(kTransforms, bag_.transforms);
}

void BagVerifier::compare_seal() {
  if (!bag_.seal) differ(topics::kRecording, kNoMessage, "the one that closes the bag");
  threelink_msgs::Recording seal;
  seal.header.stamp = bag_.contents.last();
  seal.episode = start_.episode;
  seal.state = threelink_msgs::Recording::WRITTEN;
  seal.messages = bag_.contents.messages() + 1;
  seal.contents = bag_.contents.text();
  if (bag_.seal->contents != seal.contents) {
    const FieldDifference topic = first_differing_line(bag_.seal->contents, seal.contents);
    differ("number and checksum of the messages of " + topic.field, topic.recorded, topic.replayed);
  }
  if (bag_.seal_namespace != bag_.episode_namespace)
    differ("recording, its topic", bag_.seal_namespace + topics::kRecording,
           bag_.episode_namespace + topics::kRecording);
  if (bag_.seal_time != bag_.seal->header.stamp)
    differ("recording, its time in the bag", fmt::format("{:.9f} s", bag_.seal_time.toSec()),
           fmt::format("{:.9f} s", bag_.seal->header.stamp.toSec()));
  if (bag_.seal->header.seq != 0)
    differ("recording.header.seq", fmt::format("{}", bag_.seal->header.seq), "0");
  compare(topics::kRecording, *bag_.seal, seal);
}

}  // namespace threelink_tasks
