#include "bag_file.hpp"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <unistd.h>

namespace threelink_tasks {
namespace {

namespace fs = std::filesystem;

// A chunk is closed by the message that takes it past this; 16 KiB less the largest messages.
constexpr std::uint32_t kChunkThreshold = 8 * 1024;

[[noreturn]] void fail(const std::string& what, const fs::path& path) {
  throw std::runtime_error(fmt::format("{} {}: {}", what, path.string(), std::strerror(errno)));
}

std::string date(std::time_t time) {
  std::tm local{};
  localtime_r(&time, &local);
  char text[32];
  std::strftime(text, sizeof text, "%Y-%m-%d-%H-%M-%S", &local);
  return text;
}

// The first free name from now on: another recorder may have begun an episode in the same second.
fs::path free_path(const fs::path& folder, const std::string& task, std::uint32_t episode) {
  for (std::time_t time = std::time(nullptr);; ++time) {
    const fs::path path = folder / fmt::format("{}_{}_ep{:04}.bag", task, date(time), episode);
    if (!fs::exists(path) && !fs::exists(path.string() + kActiveSuffix)) return path;
  }
}

void sync(const fs::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) fail("cannot open", path);
  const int status = fsync(descriptor);
  ::close(descriptor);
  if (status != 0) fail("cannot sync", path);
}

}  // namespace

BagFile::BagFile(const fs::path& folder, const std::string& task, std::uint32_t episode) {
  fs::create_directories(folder);
  path_ = free_path(folder, task, episode);
  open();
}

BagFile::BagFile(const fs::path& path) : path_(path) { open(); }

void BagFile::open() {
  active_ = path_.string() + kActiveSuffix;
  lock_ = ::open(active_.c_str(), O_WRONLY | O_CREAT | O_CLOEXEC, 0644);
  if (lock_ < 0) fail("cannot create", active_);
  if (flock(lock_, LOCK_EX | LOCK_NB) != 0) {
    ::close(lock_);
    fail("another recorder writes", active_);
  }
  bag_ = std::make_unique<rosbag::Bag>();
  bag_->setChunkThreshold(kChunkThreshold);
  try {
    bag_->open(active_.string(), rosbag::bagmode::Write);
  } catch (const rosbag::BagException& error) {
    let_go();
    std::error_code ignored;
    fs::remove(active_, ignored);
    throw std::runtime_error(fmt::format("cannot begin {}: {}", active_.string(), error.what()));
  }
  flushed_ = std::chrono::steady_clock::now();
}

BagFile::~BagFile() { let_go(); }

void BagFile::let_go() {
  // rosbag::Bag's destructor writes the index and ends the program if it cannot; a bag that nobody
  // closed is one on which writing failed, and is rather leaked.
  if (bag_->isOpen()) bag_.release();
  ::close(lock_);
}

void BagFile::flush_if_due() {
  const auto now = std::chrono::steady_clock::now();
  if (now - flushed_ < kFlushPeriod) return;
  bag_->setChunkThreshold(kChunkThreshold);  // closes the open chunk
  flushed_ = now;
}

void BagFile::close() {
  bag_->close();
  sync(active_, O_WRONLY);
}

void BagFile::rename() {
  fs::rename(active_, path_);
  sync(path_.parent_path(), O_RDONLY | O_DIRECTORY);
}

}  // namespace threelink_tasks
