// Files that tools write, and what becomes of what they print.
#include "threelink_sim/output.hpp"

#include <cstdio>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include "threelink_sim/files.hpp"
#include "threelink_sim/usage_error.hpp"

namespace threelink_tests {
namespace {

namespace fs = std::filesystem;
using namespace threelink_sim;

class OutputFileTest : public testing::Test {
 protected:
  void SetUp() override { fs::create_directory(folder_); }
  void TearDown() override { fs::remove_all(folder_); }

  std::string refusal(const fs::path& path, const std::vector<std::string>& inputs = {}) const {
    try {
      OutputFile("--out", path, inputs);
    } catch (const UsageError& error) {
      return error.what();
    }
    return "accepted";
  }

  const fs::path folder_ = fs::path(testing::TempDir()) / "output_test";
  const fs::path input_ = folder_ / "input", out_ = folder_ / "out";
};

TEST_F(OutputFileTest, IsWrittenOnlyAtTheEnd) {
  const OutputFile file("--out", out_);
  EXPECT_FALSE(fs::exists(out_));
  file.write("whole");
  EXPECT_EQ(read_file(out_, 100), "whole");
}

TEST_F(OutputFileTest, IsNeverAnInputByAnyName) {
  std::ofstream(input_) << "precious";
  fs::create_symlink(input_, folder_ / "link");
  fs::create_hard_link(input_, folder_ / "other");
  for (const char* name : {"input", "link", "other", "../output_test/input"})
    EXPECT_NE(refusal(folder_ / name, {"/no/such/file", input_}).find("is the same file as"),
              std::string::npos)
        << name;
  EXPECT_EQ(read_file(input_, 100), "precious");
  EXPECT_EQ(refusal(out_, {input_}), "accepted");
  EXPECT_EQ(refusal("/dev/null", {"/dev/null"}), "accepted");
}

TEST_F(OutputFileTest, RefusesWhatCannotBeWritten) {
  EXPECT_NE(refusal("").find("--out : is empty"), std::string::npos);
  EXPECT_NE(refusal(folder_).find("is a folder"), std::string::npos);
  EXPECT_NE(refusal(folder_ / "new" / "").find("is a folder"), std::string::npos);
  EXPECT_NE(refusal(folder_ / "none" / "out").find("none: No such file or directory"),
            std::string::npos);
  std::ofstream(input_) << "x";
  EXPECT_NE(refusal(input_ / "out").find("Not a directory"), std::string::npos);
  EXPECT_NE(refusal(folder_ / std::string(300, 'x')).find("File name too long"), std::string::npos);
}

TEST_F(OutputFileTest, GoesThroughLinks) {
  std::ofstream(input_) << "old";
  fs::create_symlink("input", out_);
  OutputFile("--out", out_).write("new");
  EXPECT_TRUE(fs::is_symlink(out_));
  EXPECT_EQ(read_file(input_, 100), "new");
  fs::remove(input_);
  OutputFile("--out", out_).write("again");
  EXPECT_TRUE(fs::is_symlink(out_));
  EXPECT_EQ(read_file(input_, 100), "again");
}

TEST_F(OutputFileTest, LeavesDevicesInTheirPlace) {
  OutputFile("--out", "/dev/null").write("bytes");
  EXPECT_TRUE(fs::is_character_file("/dev/null"));
  EXPECT_THROW(OutputFile("--out", "/dev/full").write("bytes"), FileError);
  EXPECT_TRUE(fs::is_character_file("/dev/full"));
}

// Status of a tool that does `work` with another standard output, and what it says.
struct ToolEnd {
  int status;
  std::string said;
};
ToolEnd end_of_tool(int standard_output, const std::function<int()>& work) {
  const std::string said = testing::TempDir() + "output_test_said";
  const pid_t child = fork();
  if (child == 0) {
    const Descriptor file(said, O_WRONLY | O_CREAT | O_TRUNC);
    dup2(file.get(), STDERR_FILENO);
    if (standard_output >= 0)
      dup2(standard_output, STDOUT_FILENO);
    else
      close(STDOUT_FILENO);
    _exit(run_tool("tool", work));
  }
  int status = 0;
  waitpid(child, &status, 0);
  EXPECT_TRUE(WIFEXITED(status));
  return {WEXITSTATUS(status), read_file(said, 1000)};
}

int print_much() {
  for (int i = 0; i < 10000; ++i) std::puts("a line");
  return 0;
}

TEST(RunTool, ReturnsTheStatusOfTheWork) {
  const Descriptor null("/dev/null", O_WRONLY);
  EXPECT_EQ(end_of_tool(null.get(), print_much).status, 0);
  EXPECT_EQ(end_of_tool(null.get(), [] { return 7; }).status, 7);
  const ToolEnd misuse = end_of_tool(null.get(), []() -> int { throw UsageError("a reason"); });
  EXPECT_EQ(misuse.status, 2);
  EXPECT_EQ(misuse.said, "tool: a reason\n");
  EXPECT_EQ(end_of_tool(null.get(), []() -> int { throw std::invalid_argument("x"); }).status, 2);
  EXPECT_EQ(end_of_tool(null.get(), []() -> int { throw std::runtime_error("x"); }).status, 1);
}

TEST(RunTool, SaysWhenNobodyTookWhatWasPrinted) {
  const Descriptor full("/dev/full", O_WRONLY);
  const auto print_little = [] {
    std::puts("a line");
    return 0;
  };
  for (const auto& work : {std::function<int()>(print_much), std::function<int()>(print_little)}) {
    const ToolEnd end = end_of_tool(full.get(), work);
    EXPECT_EQ(end.status, 1);
    EXPECT_NE(end.said.find("tool: standard output cannot be written"), std::string::npos);
  }
  int ends[2];
  ASSERT_EQ(pipe2(ends, O_CLOEXEC), 0);
  close(ends[0]);
  const ToolEnd closed = end_of_tool(ends[1], print_little);
  EXPECT_EQ(closed.status, 1);
  EXPECT_EQ(closed.said, "tool: standard output cannot be written: Broken pipe\n");
  close(ends[1]);
}

TEST(RunTool, PrintsIntoNoFileThatItOpens) {
  const std::string path = testing::TempDir() + "output_test_file";
  const ToolEnd end = end_of_tool(-1, [&] {
    const Descriptor file(path, O_WRONLY | O_CREAT | O_TRUNC);
    std::puts("for standard output");
    std::fflush(stdout);
    return 0;
  });
  EXPECT_EQ(end.status, 1);
  EXPECT_NE(end.said.find("standard output"), std::string::npos);
  EXPECT_EQ(read_file(path, 100), "");
}

}  // namespace
}  // namespace threelink_tests
