// Which states belong to an episode, and how many of them are missing.
//
// Steps count up by one. A state that leaps ahead, in steps or in time, comes after others that
// were lost, or from somebody who has no part in the episode: it waits. If the state comes that was
// due, the leap was false; if others go on from it, it was true.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <ros/time.h>
#include <threelink_msgs/SwimmerState.h>

namespace threelink_tasks {

class StateSequence {
 public:
  using State = threelink_msgs::SwimmerState;
  using Take = std::function<void(const State&)>;

  // The first state that is due.
  StateSequence(std::uint64_t step, const ros::Time& stamp) : due_(step), stamp_(stamp) {}

  // Calls `take` with every state that now turns out to belong to the episode, in order. States
  // that were there before are left out.
  void add(const State& state, const Take& take);
  // The same at the end of the episode, whose last step may be known.
  void finish(std::optional<std::uint64_t> last_step, const Take& take);

  std::optional<std::uint64_t> last() const { return last_; }  // step of the last one taken
  bool reaches(std::uint64_t step) const;  // whether that is here, or waits as the latest leap
  const ros::Time& stamp() const { return stamp_; }  // its time, or that of the start
  std::uint64_t missing() const { return missing_; }
  std::uint64_t refused() const { return refused_; }  // false leaps

 private:
  bool is_due(const State& state) const;
  void accept(const State& state, const Take& take);
  void accept_leaps(const Take& take);
  void refuse_leaps();

  std::uint64_t due_;
  ros::Time stamp_;
  std::optional<std::uint64_t> last_;
  std::size_t hinges_ = 0;  // of the first one
  std::vector<State> leaps_;
  std::uint64_t missing_ = 0, refused_ = 0;
};

}  // namespace threelink_tasks
