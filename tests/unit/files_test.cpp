// Whole files in, whole files out.
#include "threelink_sim/files.hpp"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "threelink_sim/usage_error.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;

class FilesTest : public testing::Test {
 protected:
  void SetUp() override { std::filesystem::create_directory(folder_); }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  const std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) / "files_test";
};

TEST_F(FilesTest, ReplacesWholeFiles) {
  const std::string path = folder_ / "file";
  write_file(path, "first");
  write_file(path, "second");
  EXPECT_EQ(read_file(path, 6), "second");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(FilesTest, NamesWhatItCannotDo) {
  const auto failure = [](const auto& action) -> std::string {
    try {
      action();
    } catch (const FileError& error) {
      return error.what();
    }
    return "none";
  };
  const std::string path = folder_ / "file";
  EXPECT_NE(failure([&] { read_file(path, 10); }).find(path + ": cannot open"), std::string::npos);
  EXPECT_NE(failure([&] { read_file(folder_, 10); }).find("not a file"), std::string::npos);
  EXPECT_NE(failure([&] { write_file(folder_ / "none" / "file", "x"); }).find("none/file"),
            std::string::npos);
  write_file(path, "too long");
  EXPECT_NE(failure([&] { read_file(path, 7); }).find("8 bytes, at most 7"), std::string::npos);
}

TEST_F(FilesTest, AFailureLeavesTheOldFile) {
  // A folder in the place of the file: the last step, the rename, fails.
  const std::filesystem::path path = folder_ / "taken";
  std::filesystem::create_directory(path);
  write_file(path / "old", "old");
  EXPECT_THROW(write_file(path, "new"), FileError);
  EXPECT_EQ(read_file(path / "old", 3), "old");
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(folder_), {}), 1);
}

TEST_F(FilesTest, WaitsForNoPipeAndReadsNoDevice) {
  const std::string pipe = folder_ / "pipe";
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& path : {pipe, std::string("/dev/zero"), folder_.string()}) {
    EXPECT_THROW(read_file(path, 100), FileError) << path;
    EXPECT_THROW(read_input(path, 100), UsageError) << path;
  }
}

TEST_F(FilesTest, FollowsNoLinkOfATemporaryFile) {
  // What an attacker would have to foresee: here every name is taken but those with new digits.
  const std::string path = folder_ / "file", victim = folder_ / "victim";
  std::ofstream(victim) << "precious";
  std::filesystem::create_symlink(victim, path + "." + std::to_string(getpid()) + ".tmp");
  write_file(path, "new");
  EXPECT_EQ(read_file(victim, 100), "precious");
  EXPECT_EQ(read_file(path, 100), "new");
  EXPECT_FALSE(std::filesystem::is_symlink(path));
}

TEST_F(FilesTest, KeepsThePermissionsOfTheOldFile) {
  const std::filesystem::path path = folder_ / "file";
  write_file(path, "old");
  std::filesystem::permissions(path, std::filesystem::perms(0640));
  write_file(path, "new");
  EXPECT_EQ(std::filesystem::status(path).permissions(), std::filesystem::perms(0640));
}

TEST_F(FilesTest, KnowsItsTemporaryFiles) {
  EXPECT_TRUE(is_temporary_name("policy.safetensors.123.tmp"));
  for (const char* name : {"policy.safetensors", "policy.tmp", "a.b.tmp", "a..tmp", "a.1.tmp.csv"})
    EXPECT_FALSE(is_temporary_name(name)) << name;
}

TEST(DescriptorTest, ClosesWhatItHolds) {
  int number;
  {
    Descriptor first("/dev/null", 0);
    ASSERT_TRUE(first);
    number = first.get();
    Descriptor second(std::move(first));
    EXPECT_FALSE(first);
    EXPECT_EQ(second.get(), number);
    first = std::move(second);
    EXPECT_EQ(first.get(), number);
  }
  EXPECT_EQ(close(number), -1);
  EXPECT_FALSE(Descriptor("/no/such/file", 0));
}

}  // namespace
}  // namespace threelink_tests
