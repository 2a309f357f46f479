// What rviz shows of the world: obstacles, the flow around the swimmer, and contact.
//
//   world_markers  visualization_msgs/MarkerArray: obstacles (grey), the flow as arrows whose
//   length
//                  and colour tell the speed, the force of the obstacles on the swimmer (red)
#pragma once

#include <memory>

#include <ros/node_handle.h>
#include <threelink_msgs/SwimmerState.h>
#include <threelink_msgs/WorldState.h>
#include <visualization_msgs/MarkerArray.h>

#include "threelink_sim/node/conversions.hpp"
#include "threelink_sim/world/world.hpp"

namespace threelink_sim {

class WorldView {
 public:
  WorldView(ros::NodeHandle& node, std::shared_ptr<const World> world, const Scales& scales);

  // Publishes what is around the swimmer at the time t [T0] of the flow; costs nothing without
  // subscribers.
  void draw(const threelink_msgs::SwimmerState& state, const threelink_msgs::WorldState& world,
            double t);

 private:
  visualization_msgs::Marker marker(const char* name, int id, int type) const;
  void add_obstacles(const Eigen::Vector2d& centre, visualization_msgs::MarkerArray& array) const;
  void add_flow(const Eigen::Vector2d& centre, double t,
                visualization_msgs::MarkerArray& array) const;

  std::shared_ptr<const World> world_;
  Scales scales_;
  ros::Publisher publisher_;
};

}  // namespace threelink_sim
