/// @file
/// Names of topics and services, relative: launch files put all into the namespace `threelink`.
#pragma once

namespace threelink_sim {
/// Names of topics, actions and services; docs/nodes.md describes each.
namespace topics {

constexpr char kClock[] = "/clock";                ///< simulation time
constexpr char kJointStates[] = "joint_states";    ///< hinge angles, for robot_state_publisher
constexpr char kPose[] = "pose";                   ///< centroid and heading
constexpr char kState[] = "state";                 ///< threelink_msgs/SwimmerState after each step
constexpr char kWorldState[] = "world_state";      ///< threelink_msgs/WorldState after each step
constexpr char kWorldMarkers[] = "world_markers";  ///< display of the world
constexpr char kTarget[] = "target";               ///< target of the current state
constexpr char kObservation[] = "observation";     ///< observation of the current state
constexpr char kHingeRates[] = "hinge_rates";      ///< action of the agent
constexpr char kEpisode[] = "episode";             ///< start, end and configuration of an episode
constexpr char kAbort[] = "abort";                 ///< end of an episode by the simulator
constexpr char kRecording[] = "recording";         ///< a finished bag
constexpr char kPolicy[] = "policy";               ///< policy of a training
constexpr char kTrainingStatus[] = "training_status";  ///< progress of a training
constexpr char kWorkers[] = "workers";                 ///< status of workers
constexpr char kLeases[] = "leases";                   ///< leases of the learner
constexpr char kEpisodes[] = "episodes";               ///< batches of workers
constexpr char kMarkers[] = "markers";                 ///< display of the swimmer
constexpr char kSwimmerPath[] = "swimmer_path";        ///< the centroid's path
constexpr char kTargetPath[] = "target_path";          ///< the target's path
constexpr char kWaypoints[] = "waypoints";             ///< display of the waypoints
constexpr char kTargetMarker[] = "target_marker";      ///< interactive
constexpr char kClickedPoint[] = "/clicked_point";     ///< rviz's "Publish Point"
constexpr char kRunEpisode[] = "run_episode";          ///< action
constexpr char kTrain[] = "train";                     ///< action
constexpr char kReset[] = "reset";                     ///< service
constexpr char kLoadPolicy[] = "load_policy";          ///< service

}  // namespace topics

/// Names of frames.
namespace frames {

constexpr char kWorld[] = "world";         ///< fixed
constexpr char kBaseLink[] = "base_link";  ///< heading link: origin its midpoint, x along it

}  // namespace frames
}  // namespace threelink_sim
