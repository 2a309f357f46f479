// The folder of a run: resuming to the bit, damaged checkpoints, one process at a time.
#include "threelink_agent/training/run_folder.hpp"

#include <algorithm>
#include <chrono>
#include <csignal>
#include <fstream>
#include <iterator>
#include <random>
#include <thread>

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "small_training.hpp"
#include "threelink_sim/files.hpp"

namespace threelink_tests {
namespace {

namespace fs = std::filesystem;
using namespace threelink_agent;
using Opening = RunFolder::Opening;

TrainConfig ten_updates() {
  TrainConfig config = small();
  config.episodes = 12 * 10;
  return config;
}

std::string text_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

class RunFolderTest : public testing::Test {
 protected:
  RunFolderTest()
      : path_(fs::path(testing::TempDir()) / ("run_folder_test_" + std::to_string(getpid()))) {
    fs::remove_all(path_);
  }
  ~RunFolderTest() override { fs::remove_all(path_); }

  // Trains up to `until` updates in all and leaves as a process does that is killed; or finishes.
  // Times in metrics.csv are 0, so that files can be compared.
  std::string train(Opening opening, std::uint32_t until, const TrainConfig& config) {
    RunFolder folder(path_, opening, config, "fused");
    auto ppo = make_ppo_update(Backend::kFused, config, 1);
    Trainer trainer = folder.checkpoint()
                          ? Trainer(config, std::move(ppo), std::make_unique<LocalRollouts>(1),
                                    folder.checkpoint()->state)
                          : Trainer(config, std::move(ppo));
    warnings_ = folder.warnings();
    begun_at_ = trainer.state().update;
    folder.begin();
    while (!trainer.finished() && trainer.state().update < until) {
      folder.add(trainer.update(), 0, 0);
      folder.save(trainer, 0);
    }
    if (trainer.finished()) folder.finish(trainer, 0);
    return trainer.policy().sha256();
  }

  std::string refusal(Opening opening, const TrainConfig& config,
                      const std::string& backend = "fused") {
    try {
      RunFolder folder(path_, opening, config, backend);
      return "accepted";
    } catch (const RunFolderError& error) {
      return error.what();
    }
  }

  std::vector<fs::path> checkpoints() const {
    std::vector<fs::path> found;
    for (const auto& entry : fs::directory_iterator(path_))
      if (entry.path().filename().string().rfind("checkpoint_", 0) == 0)
        found.push_back(entry.path());
    std::sort(found.begin(), found.end());
    return found;
  }

  fs::path path_;
  std::vector<std::string> warnings_;
  std::uint32_t begun_at_ = 0;
};

TEST_F(RunFolderTest, AnUnbrokenRunLeavesItsFiles) {
  const std::string sha256 = train(Opening::kNew, 10, ten_updates());
  EXPECT_EQ(Policy::load(path_ / "last.safetensors").sha256(), sha256);
  EXPECT_TRUE(fs::exists(path_ / "policy.safetensors"));
  EXPECT_EQ(text_of(path_ / "config.yaml"), to_yaml(ten_updates()));
  EXPECT_LE(checkpoints().size(), 3u);
  EXPECT_EQ(checkpoints().back().filename(), "checkpoint_00000010.safetensors");
  const std::string metrics = text_of(path_ / "metrics.csv");
  EXPECT_EQ(std::count(metrics.begin(), metrics.end(), '\n'), 11);
}

TEST_F(RunFolderTest, ABrokenRunEndsWithTheBitsOfAnUnbrokenOne) {
  train(Opening::kNew, 10, ten_updates());
  const std::string last = text_of(path_ / "last.safetensors");
  const std::string best = text_of(path_ / "policy.safetensors");
  const std::string metrics = text_of(path_ / "metrics.csv");
  fs::remove_all(path_);
  for (std::uint32_t until : {0, 1, 4, 5, 9, 10}) {
    train(Opening::kResume, until, ten_updates());
    // Half a row of an update that no checkpoint knows of, and what a killed write leaves.
    std::ofstream(path_ / "metrics.csv", std::ios::app) << "7,84,42";
    std::ofstream(path_ / "policy.safetensors.1.tmp") << "half";
  }
  EXPECT_GT(begun_at_, 0u);
  train(Opening::kResume, 10, ten_updates());
  EXPECT_EQ(text_of(path_ / "last.safetensors"), last);
  EXPECT_EQ(text_of(path_ / "policy.safetensors"), best);
  EXPECT_EQ(text_of(path_ / "metrics.csv"), metrics);
  EXPECT_FALSE(fs::exists(path_ / "policy.safetensors.1.tmp"));
}

TEST_F(RunFolderTest, TheNewestCheckpointThatVerifiesIsTaken) {
  const std::string sha256 = train(Opening::kNew, 10, ten_updates());
  const auto found = checkpoints();
  ASSERT_EQ(found.size(), 3u);
  fs::resize_file(found[2], 1000);
  std::fstream(found[1], std::ios::in | std::ios::out).seekp(-99, std::ios::end).put('?').put('!');
  EXPECT_EQ(train(Opening::kResume, 10, ten_updates()), sha256);
  ASSERT_EQ(warnings_.size(), 2u);
  EXPECT_EQ(warnings_[0].rfind(found[2].string() + ": ", 0), 0u) << warnings_[0];
  EXPECT_EQ(warnings_[1].rfind(found[1].string() + ": damaged", 0), 0u) << warnings_[1];
  // Where none verifies, a run does not begin again unasked.
  for (const fs::path& checkpoint : checkpoints()) fs::resize_file(checkpoint, 0);
  EXPECT_NE(refusal(Opening::kResume, ten_updates()).find("no checkpoint can be used"),
            std::string::npos);
  for (const fs::path& checkpoint : checkpoints()) fs::remove(checkpoint);
  EXPECT_NE(refusal(Opening::kResume, ten_updates()).find("holds a policy, but no checkpoint"),
            std::string::npos);
}

TEST_F(RunFolderTest, AProcessKilledInTheMiddleOfAWriteLeavesWholeFiles) {
  TrainConfig config = small();
  config.episodes = 1'000'000;
  std::mt19937 random(0);
  std::uint32_t before = 0;
  for (int kill_number = 0; kill_number < 60; ++kill_number) {
    const pid_t child = fork();
    if (child == 0) {
      train(Opening::kResume, config.updates(), config);
      _exit(0);
    }
    // The first process is killed once it has written a checkpoint, however long that takes here.
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
    while (kill_number == 0 && (!fs::exists(path_) || checkpoints().empty()) &&
           std::chrono::steady_clock::now() < deadline)
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    std::this_thread::sleep_for(std::chrono::microseconds(random() % 60'000));
    kill(child, SIGKILL);
    ASSERT_EQ(waitpid(child, nullptr, 0), child);
    const RunFolder folder(path_, Opening::kResume, config, "fused");
    EXPECT_TRUE(folder.warnings().empty()) << folder.warnings().front();
    const std::uint32_t update = folder.checkpoint() ? folder.checkpoint()->state.update : 0;
    EXPECT_GE(update, before);
    before = update;
  }
  EXPECT_GT(before, 0u);
}

TEST_F(RunFolderTest, OnlyTheSameRunIsResumed) {
  train(Opening::kNew, 10, ten_updates());
  EXPECT_NE(refusal(Opening::kNew, ten_updates()).find("is not empty"), std::string::npos);
  TrainConfig longer = ten_updates();
  longer.episodes *= 2;
  longer.update.clip = 0.3;
  EXPECT_NE(refusal(Opening::kResume, longer).find("episodes = 240, but this run has 120"),
            std::string::npos);
  EXPECT_NE(refusal(Opening::kResume, ten_updates(), "libtorch")
                .find("--backend libtorch, but this run has fused"),
            std::string::npos);
  EXPECT_EQ(refusal(Opening::kResume, ten_updates()), "accepted");
}

TEST_F(RunFolderTest, StrangersFilesAreLeftAlone) {
  fs::create_directories(path_);
  std::ofstream(path_ / "thesis.tex") << "x";
  EXPECT_NE(refusal(Opening::kNew, small()).find("is not empty"), std::string::npos);
  EXPECT_NE(refusal(Opening::kResume, small()).find("holds no run"), std::string::npos);
  EXPECT_FALSE(fs::exists(path_ / "run.lock"));
}

TEST_F(RunFolderTest, ASecondTrainerEndsNamingTheFirst) {
  const RunFolder first(path_, Opening::kNew, small(), "fused");
  EXPECT_NE(
      refusal(Opening::kResume, small()).find("is in use by process " + std::to_string(getpid())),
      std::string::npos);
}

// A limit on the size of files stands for a full disk: a checkpoint has some 20 kB.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    std::signal(SIGXFSZ, SIG_IGN);
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() { setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_;
};

TEST_F(RunFolderTest, WhatCannotBeWrittenIsNamedAndLeavesTheOldFiles) {
  const TrainConfig config = ten_updates();
  {
    RunFolder folder(path_, Opening::kNew, config, "fused");
    Trainer trainer = trainer_of(config);
    folder.begin();
    for (int update = 0; update < 3; ++update) folder.add(trainer.update(), 0, 0);
    folder.finish(trainer, 0);
    const std::string before = text_of(path_ / "metrics.csv");
    const std::string checkpoint = text_of(path_ / "checkpoint_00000003.safetensors");
    {
      const FileSizeLimit limit(1000);
      for (int update = 0; update < 4; ++update) {
        try {
          folder.add(trainer.update(), 0, 0);
          folder.finish(trainer, 0);
          FAIL() << "a limit of 1000 bytes let everything through";
        } catch (const threelink_sim::FileError& error) {
          const std::string text = error.what();
          EXPECT_NE(text.find(path_.string()), std::string::npos) << text;
          EXPECT_NE(text.find(" bytes: File too large"), std::string::npos) << text;
        }
        EXPECT_NO_THROW(folder.save(trainer, 0));  // has nothing to say while rows wait
      }
      // Whole rows only.
      EXPECT_EQ(text_of(path_ / "metrics.csv").rfind(before, 0), 0u);
      EXPECT_EQ(text_of(path_ / "metrics.csv").back(), '\n');
      EXPECT_EQ(text_of(path_ / "checkpoint_00000003.safetensors"), checkpoint);
    }
    // With room again, nothing is missing. A checkpoint that failed in the background may be told
    // of only now.
    while (!trainer.finished()) {
      const UpdateReport report = trainer.update();
      try {
        folder.add(report, 0, 0);
      } catch (const threelink_sim::FileError& error) {
        EXPECT_NE(std::string(error.what()).find("checkpoint_"), std::string::npos) << error.what();
      }
    }
    folder.finish(trainer, 0);
  }
  const std::string metrics = text_of(path_ / "metrics.csv");
  const std::string last = text_of(path_ / "last.safetensors");
  fs::remove_all(path_);
  train(Opening::kNew, 10, config);
  EXPECT_EQ(text_of(path_ / "metrics.csv"), metrics);
  EXPECT_EQ(text_of(path_ / "last.safetensors"), last);
}

}  // namespace
}  // namespace threelink_tests
