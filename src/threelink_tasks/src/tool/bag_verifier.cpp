#include "bag_verifier.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "threelink_sim/node/topics.hpp"

namespace threelink_tasks {
namespace {

namespace topics = threelink_sim::topics;
namespace frames = threelink_sim::frames;
using threelink_msgs::Episode;
using threelink_sim::HingeVector;

bool all_zero(const std::vector<double>& values) {
  return std::all_of(values.begin(), values.end(), [](double value) { return value == 0; });
}

}  // namespace

void BagVerifier::differ(const std::string& field, const std::string& recorded,
                         const std::string& replayed) const {
  throw Difference{step_, {field, recorded, replayed}};
}

Verdict BagVerifier::verify() {
  verdict_.whole = bag_.seal.has_value();
  try {
    begin();
    do {
      compare_state();
    } while (answer());
    compare_end();
    compare_seal();
    if (late()) {
      step_ = 0;
      differ(topics::kState, fmt::format("the first one is of step {}", first_step_), "one");
    }
  } catch (const Difference& difference) {
    verdict_.difference = difference;
  }
  return std::move(verdict_);
}

ros::Time BagVerifier::stamp() const {
  return ros::Time().fromNSec(first_stamp_.toNSec() +
                              (step_ - first_step_) * simulator_.lockstep().tick);
}

bool BagVerifier::may_end_here() const {
  const Episode* end = bag_.episodes.next();
  return !bag_.states.next() && (!end || end->status == Episode::ABORTED);
}

void BagVerifier::compare_state() {
  const threelink_msgs::SwimmerState& recorded = expect(topics::kState, bag_.states);
  state_.header.stamp = stamp();
  state_.header.frame_id = frames::kWorld;
  state_.episode = start_.episode;
  state_.step = step_;
  to_message(simulator_.environment.model, replay_->record(0), state_);
  if (late() && step_ == first_step_) {  // what the step before did
    state_.hinge_rates = recorded.hinge_rates;
    state_.power = recorded.power;
    state_.work = recorded.work;
    state_.reward = recorded.reward;
  }
  compare(topics::kState, recorded, state_);
  compare_world_state();

  sensor_msgs::JointState joints;
  to_joint_state(state_, simulator_.scales, joints);
  compare_all(topics::kJointStates, bag_.joint_states, joints);
  geometry_msgs::PoseStamped pose;
  to_pose(state_, simulator_.scales, pose);
  compare_all(topics::kPose, bag_.poses, pose);
  tf2_msgs::TFMessage transforms;
  transforms.transforms.resize(1);
  to_transform(state_, simulator_.scales, transforms.transforms[0]);
  compare_all(kTransforms, bag_.transforms, transforms);
}

void BagVerifier::compare_world_state() {
  if (!replay_->has_world()) return;
  const auto* recorded = expect_answer(topics::kWorldState, bag_.world_states);
  if (!recorded) return;
  threelink_msgs::WorldState world;
  world.header = state_.header;
  world.episode = state_.episode;
  world.step = state_.step;
  to_message(*replay_, replay_->record(0), world);
  if (late() && step_ == first_step_) {  // what the step before did
    world.dissipation = recorded->dissipation;
    world.contacts = recorded->contacts;
    world.contact_force = recorded->contact_force;
    world.contact_torque = recorded->contact_torque;
  }
  compare(topics::kWorldState, *recorded, world);
}

bool BagVerifier::answer() {
  const double length = simulator_.scales.length;
  const geometry_msgs::PointStamped* asked = bag_.targets.next();
  if (!verdict_.targets_proven && asked && asked->header.stamp == stamp()) {
    const Eigen::Vector2d chosen = Eigen::Vector2d(asked->point.x, asked->point.y) / length;
    if (task_->takes_points() && chosen != task_->target()) task_->take_point(chosen);
  }
  const Eigen::Vector2d centroid = replay_->centroid(0);
  if (!late()) outcome_ = task_->observe(centroid);
  end_before_ = end_;
  end_ = {stamp(), task_->waypoint(),
          measure(step_, simulator_.environment.dt, first_centroid_, centroid, task_->target())};
  if (step_ == 0) compare_start();
  if (outcome_ != Outcome::kRunning) return false;

  const auto* target = expect_answer(topics::kTarget, bag_.targets);
  if (!target) return false;
  geometry_msgs::PointStamped replayed;
  replayed.header.stamp = stamp();
  replayed.header.frame_id = frames::kWorld;
  const Eigen::Vector2d metres = task_->target() * length;
  replayed.point.x = verdict_.targets_proven ? metres.x() : target->point.x;
  replayed.point.y = verdict_.targets_proven ? metres.y() : target->point.y;
  compare(topics::kTarget, *target, replayed);

  const auto* recorded = expect_answer(topics::kObservation, bag_.observations);
  if (!recorded) return false;
  replay_->aim(0, Eigen::Vector2d(target->point.x, target->point.y) / length);
  threelink_msgs::Observation observation;
  observation.header.stamp = stamp();
  observation.episode = start_.episode;
  observation.step = step_;
  to_message(*replay_, observation);
  compare(topics::kObservation, *recorded, observation);

  const threelink_msgs::SwimmerState* next = bag_.states.next();
  const bool none_needed = next && all_zero(next->hinge_rates);
  const threelink_msgs::HingeRates* rates =
      none_needed ? bag_.rates.take(stamp()) : expect_answer(topics::kHingeRates, bag_.rates);
  if (rates) compare_rates(*rates, observation);
  // An agent that was restarted has answered once more.
  while (const auto* again = bag_.rates.take(stamp())) compare_rates(*again, observation);
  if (!next && may_end_here()) return false;
  step(rates);
  return true;
}

void BagVerifier::compare_rates(const threelink_msgs::HingeRates& recorded,
                                const threelink_msgs::Observation& observation) {
  threelink_msgs::HingeRates rates;
  rates.header.stamp = stamp();
  rates.episode = start_.episode;
  rates.step = step_;
  const threelink_agent::Policy* policy = policies_.find(recorded.policy);
  rates.policy = policy ? policy->id() : start_.policy_sha256.substr(0, kIdDigits);
  const bool proven =
      policy && static_cast<std::size_t>(policy->observation_size()) == observation.values.size() &&
      policy->hinges() == simulator_.environment.model.hinges();
  if (proven) {
    rates.rates.resize(policy->hinges());
    if (action_seed_) {
      policy->sample(observation.values.data(),
                     {*action_seed_, start_.episode, static_cast<std::uint32_t>(step_)},
                     rates.rates.data());
    } else {
      policy->act(observation.values.data(), rates.rates.data());
    }
  } else {
    rates.rates = recorded.rates;
    rates.rates.resize(simulator_.environment.model.hinges());
    for (double& rate : rates.rates)
      if (!(std::abs(rate) <= 1)) rate = 0;  // the simulator would have refused it
  }
  compare(topics::kHingeRates, recorded, rates);
  if (proven) ++verdict_.actions_proven;
}

void BagVerifier::step(const threelink_msgs::HingeRates* rates) {
  const HingeVector zeros = HingeVector::Zero(simulator_.environment.model.hinges());
  const threelink_sim::Environment before = *replay_;
  replay_->step(rates ? rates->rates.data() : zeros.data());
  // The watchdog has taken the step if zeros were applied that nobody commanded.
  const threelink_msgs::SwimmerState* next = bag_.states.next();
  if (next && all_zero(next->hinge_rates) &&
      (!rates || !replay_->record(0).hinge_rates.isZero(0))) {
    replay_ = before;
    replay_->step(zeros.data());
    ++verdict_.watchdog_steps;
  }
  ++step_;
}

}  // namespace threelink_tasks
