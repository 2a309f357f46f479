// Bags in a folder that others use as well: no file of theirs is taken, followed or written over.
#include "bag_file.hpp"

#include <cstdlib>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <threelink_msgs/Episode.h>
#include <unistd.h>

#include "leftover_bag.hpp"

namespace {

namespace fs = std::filesystem;
using threelink_tasks::BagFile;
using threelink_tasks::leftover_bags;
using threelink_tasks::recover_leftover;
using threelink_tasks::why_not_writable;

class BagFileTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string name = testing::TempDir() + "bags_XXXXXX";
    ASSERT_NE(mkdtemp(name.data()), nullptr);
    folder_ = name;
  }
  void TearDown() override { fs::remove_all(folder_); }

  // The names of bags that begin within the next seconds.
  std::vector<fs::path> next_names() const {
    std::vector<fs::path> names;
    for (std::time_t time = std::time(nullptr); names.size() < 5; ++time) {
      std::tm local{};
      localtime_r(&time, &local);
      char date[32];
      std::strftime(date, sizeof date, "%Y-%m-%d-%H-%M-%S", &local);
      names.push_back(folder_ / ("pursuit_" + std::string(date) + "_ep0001.bag"));
    }
    return names;
  }

  static void write_one(BagFile& bag) {
    bag.write("/threelink/episode", ros::Time(1), threelink_msgs::Episode());
  }

  fs::path folder_;
};

TEST_F(BagFileTest, FollowsNoLink) {
  const fs::path victim = folder_ / "victim";
  std::ofstream(victim) << "untouched";
  const std::vector<fs::path> names = next_names();
  for (std::size_t i = 0; i < names.size(); ++i)
    fs::create_symlink(victim, i % 2 == 0 ? names[i].string() + ".active" : names[i].string());
  BagFile bag(folder_, "pursuit", 1);
  write_one(bag);
  bag.close();
  bag.rename();
  EXPECT_FALSE(fs::is_symlink(bag.path()));
  EXPECT_GT(fs::file_size(bag.path()), 4096u);
  EXPECT_EQ(fs::file_size(victim), 9u);
  EXPECT_TRUE(leftover_bags(folder_).empty());
}

TEST_F(BagFileTest, TwoOfOneSecondHaveTwoNames) {
  BagFile one(folder_, "pursuit", 1), other(folder_, "pursuit", 1);
  EXPECT_NE(one.active_path(), other.active_path());
  EXPECT_TRUE(leftover_bags(folder_).empty());  // both are locked, though empty
  write_one(one);
  write_one(other);
  for (BagFile* bag : {&one, &other}) {
    bag->close();
    bag->rename();
    EXPECT_TRUE(fs::exists(bag->path()));
  }
}

TEST_F(BagFileTest, AnotherRecordersLockIsRespected) {
  const fs::path leftover = folder_ / "pursuit_2020-01-01-00-00-00_ep0001.bag.active";
  std::ofstream(leftover).close();
  const int other = open(leftover.c_str(), O_RDONLY | O_CLOEXEC);
  ASSERT_EQ(flock(other, LOCK_EX | LOCK_NB), 0);
  EXPECT_TRUE(leftover_bags(folder_).empty());
  EXPECT_FALSE(recover_leftover(leftover));
  EXPECT_TRUE(fs::exists(leftover));
  close(other);
  EXPECT_EQ(leftover_bags(folder_).size(), 1u);
  EXPECT_FALSE(recover_leftover(leftover));
  EXPECT_FALSE(fs::exists(leftover));
}

TEST_F(BagFileTest, LeftoversOfOthersAreLeftAlone) {
  for (const char* name : {"2020-01-01-00-00-00.bag.active", "mine.bag.active", "x.active"})
    std::ofstream(folder_ / name).close();
  EXPECT_TRUE(leftover_bags(folder_).empty());
}

TEST_F(BagFileTest, ATaskWithoutAPlainNameHasNoBag) {
  EXPECT_THROW(BagFile(folder_, "../outside", 1), std::invalid_argument);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(BagFileTest, FoldersAreTriedAtTheStart) {
  EXPECT_EQ(why_not_writable(folder_ / "a" / "b"), "");
  EXPECT_TRUE(fs::is_empty(folder_ / "a" / "b"));
  std::ofstream(folder_ / "file").close();
  EXPECT_NE(why_not_writable(folder_ / "file"), "");
  EXPECT_NE(why_not_writable(folder_ / "file" / "b"), "");
  EXPECT_NE(why_not_writable("/proc/bags"), "");
}

}  // namespace
