/// @file
/// A path for rviz that covers an episode of any length with a bounded number of poses.
#pragma once

#include <cstdint>

#include <nav_msgs/Path.h>

#include "threelink_sim/node/topics.hpp"

namespace threelink_sim {

/// The path; its resolution is halved each time it is full.
class ThinnedPath {
 public:
  ThinnedPath() { path_.header.frame_id = frames::kWorld; }

  void clear() {
    path_.poses.clear();
    stride_ = 1;
  }

  /// Adds the pose in state `step`; steps must increase.
  void add(std::uint64_t step, const geometry_msgs::PoseStamped& pose) {
    path_.header.stamp = pose.header.stamp;
    if (step % stride_ != 0) return;
    path_.poses.push_back(pose);
    if (path_.poses.size() < kPoses) return;
    for (std::size_t i = 0; 2 * i < kPoses; ++i) path_.poses[i] = path_.poses[2 * i];
    path_.poses.resize(kPoses / 2);
    stride_ *= 2;
  }

  const nav_msgs::Path& message() const { return path_; }

 private:
  static constexpr std::size_t kPoses = 2000;  ///< at this number every second pose is dropped

  nav_msgs::Path path_;
  std::uint64_t stride_ = 1;  ///< [steps] between poses
};

}  // namespace threelink_sim
