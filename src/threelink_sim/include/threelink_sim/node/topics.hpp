/// @file
/// Names of topics and services, relative: launch files put all into the namespace `threelink`.
#pragma once

namespace threelink_sim {
namespace topics {

constexpr char kClock[] = "/clock";
constexpr char kJointStates[] = "joint_states";
constexpr char kPose[] = "pose";
constexpr char kState[] = "state";
constexpr char kWorldState[] = "world_state";
constexpr char kWorldMarkers[] = "world_markers";
constexpr char kTarget[] = "target";
constexpr char kObservation[] = "observation";
constexpr char kHingeRates[] = "hinge_rates";
constexpr char kEpisode[] = "episode";
constexpr char kAbort[] = "abort";
constexpr char kRecording[] = "recording";
constexpr char kPolicy[] = "policy";
constexpr char kTrainingStatus[] = "training_status";
constexpr char kWorkers[] = "workers";
constexpr char kLeases[] = "leases";
constexpr char kEpisodes[] = "episodes";
constexpr char kMarkers[] = "markers";
constexpr char kSwimmerPath[] = "swimmer_path";
constexpr char kTargetPath[] = "target_path";
constexpr char kWaypoints[] = "waypoints";
constexpr char kTargetMarker[] = "target_marker";   ///< interactive
constexpr char kClickedPoint[] = "/clicked_point";  ///< rviz's "Publish Point"
constexpr char kRunEpisode[] = "run_episode";       ///< action
constexpr char kTrain[] = "train";                  ///< action
constexpr char kReset[] = "reset";                  ///< service
constexpr char kLoadPolicy[] = "load_policy";       ///< service

}  // namespace topics

namespace frames {

constexpr char kWorld[] = "world";         ///< fixed
constexpr char kBaseLink[] = "base_link";  ///< heading link: origin its midpoint, x along it

}  // namespace frames
}  // namespace threelink_sim
