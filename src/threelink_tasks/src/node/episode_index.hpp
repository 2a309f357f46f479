// episodes.csv, the list of all episodes beside their bags.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <threelink_msgs/Episode.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/SwimmerState.h>

namespace threelink_tasks {

// One row. Cells of what nobody could say stay empty.
struct IndexRow {
  std::uint32_t episode = 0;
  std::string bag;  // name in the same folder
  std::string task;
  std::uint64_t seed = 0;
  std::string status;  // captured, timed_out or aborted
  std::uint64_t steps = 0;
  std::optional<double> time;        // [T0]
  std::optional<double> distance;    // [L] centroid to target at the end
  std::optional<double> mean_speed;  // [L/T0]
  std::string policy_sha256;
  std::uint64_t messages = 0;  // in the bag
  bool recovered = false;      // the bag was left open by a recorder that died
  std::uint64_t missing = 0;   // states that were lost on the way to the bag
};

// What the messages of a bag say about its episode. Without an Episode message that ends it, the
// episode counts as aborted in the last state seen.
class EpisodeStory {
 public:
  void hear(const threelink_msgs::Episode& message);
  void hear(const threelink_msgs::SwimmerState& message);
  void hear(const threelink_msgs::Observation& message);
  template <class Message>
  void hear(const Message&) {}  // the others tell nothing new

  IndexRow row() const;

 private:
  IndexRow row_;
  std::uint64_t due_ = 0;  // step of the next state
  bool ended_ = false;
};

// "started", "captured", "timed_out", "aborted"
std::string status_name(std::uint8_t status);

// Appends a row to FOLDER/episodes.csv, whole or not at all, also if several recorders share the
// folder. No cell needs quotes: text that is no plain name stays out. A file that lacks the last
// column, as older versions wrote it, gets it. Throws std::runtime_error naming the file.
void append_to_index(const std::filesystem::path& folder, const IndexRow& row);

// Names of the bags that FOLDER/episodes.csv lists, oldest first; none if it cannot be read. Rows
// that are not as the recorder writes them list nothing.
std::vector<std::string> indexed_bags(const std::filesystem::path& folder);

}  // namespace threelink_tasks
