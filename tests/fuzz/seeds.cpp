// Writes the seeds of the corpora that are no copies of shipped files: seeds CORPUS_FOLDER. To be
// run again where a format has changed.
#include <filesystem>
#include <iostream>
#include <memory>
#include <vector>

#include <ros/serialization.h>

#include "threelink_agent/distributed/episode_batch.hpp"
#include "threelink_agent/training/checkpoint.hpp"
#include "threelink_agent/training/fused_update.hpp"
#include "threelink_sim/files.hpp"
#include "tiny_training.hpp"
#include "training_messages.hpp"

namespace {

using namespace threelink_agent;

void write(const std::filesystem::path& path, const std::string& bytes) {
  std::filesystem::create_directories(path.parent_path());
  threelink_sim::write_file(path.string(), bytes);
}

std::string serialized(EpisodeBatch&& batch) {
  const threelink_msgs::EpisodeBatch message = to_message(std::move(batch));
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return {bytes.begin(), bytes.end()};
}

// What a worker hands in for the two episodes of an update.
EpisodeBatch whole_update(const TrainConfig& config) {
  EpisodeBatch batch;
  batch.session = 1;
  batch.policy = std::string(64, 'a');
  batch.lease = 1;
  batch.worker = 2;
  put(Rollout(config.environment, static_cast<int>(config.update.episodes)), batch);
  batch.checksum = checksum(batch);
  return batch;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: seeds CORPUS_FOLDER\n";
    return 2;
  }
  const std::filesystem::path corpus = argv[1];
  const TrainConfig config = threelink_fuzz::tiny_training();
  Trainer trainer(config, std::make_unique<FusedUpdate>(config, 1),
                  std::make_unique<LocalRollouts>(1));
  Checkpoint checkpoint{config, "fused", trainer.state(), 0, 0};
  write(corpus / "checkpoint" / "start", serialize(checkpoint));
  trainer.update();
  checkpoint.state = trainer.state();
  write(corpus / "checkpoint" / "one_update", serialize(checkpoint));
  write(corpus / "policy" / "tiny", trainer.policy().serialize());
  write(corpus / "episode_batch" / "whole_update", serialized(whole_update(config)));
  EpisodeBatch given_back;
  given_back.given_back = "no such policy";
  write(corpus / "episode_batch" / "given_back", serialized(std::move(given_back)));
  return 0;
}
