#include "bag_file.hpp"

#include <cerrno>
#include <cstring>
#include <ctime>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../core/bag_name.hpp"

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

void sync(const fs::path& path, int flags) {
  const int descriptor = ::open(path.c_str(), flags | O_CLOEXEC);
  if (descriptor < 0) fail("cannot open", path);
  const int status = fsync(descriptor);
  ::close(descriptor);
  if (status != 0) fail("cannot sync", path);
}

}  // namespace

// The first free name from now on: another recorder may have begun an episode in the same second.
BagFile::BagFile(const fs::path& folder, const std::string& task, std::uint32_t episode) {
  fs::create_directories(folder);
  for (std::time_t time = std::time(nullptr);; ++time) {
    path_ = folder / bag_name(task, date(time), episode);
    if (!fs::exists(fs::symlink_status(path_)) && create()) break;
  }
  open();
}

BagFile::BagFile(const fs::path& path) : path_(path) {
  if (!create()) {
    errno = EEXIST;
    fail("cannot create", active_);
  }
  open();
}

// False if there is such a file, or another recorder took the new one for a leftover.
bool BagFile::create() {
  active_ = path_.string() + kActiveSuffix;
  lock_ = ::open(active_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0644);
  if (lock_ < 0) {
    if (errno == EEXIST) return false;
    fail("cannot create", active_);
  }
  struct stat status {};
  if (flock(lock_, LOCK_EX | LOCK_NB) == 0 && fstat(lock_, &status) == 0 && status.st_nlink > 0)
    return true;
  ::close(lock_);
  return false;
}

void BagFile::open() {
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
  if (bag_->isOpen()) static_cast<void>(bag_.release());
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

std::string why_not_writable(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (!fs::is_directory(folder)) {
    if (!error) error = std::make_error_code(std::errc::not_a_directory);
    return fmt::format("the folder cannot be made: {}", error.message());
  }
  const fs::path trial = folder / fmt::format(".threelink_{}.tmp", getpid());
  const int descriptor =
      ::open(trial.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_NOFOLLOW | O_CLOEXEC, 0600);
  // A disk that is full may have room later: that is told of each episode.
  if (descriptor < 0 && errno != ENOSPC && errno != EDQUOT && errno != EEXIST)
    return fmt::format("no file can be made in that folder: {}", std::strerror(errno));
  if (descriptor >= 0) {
    ::close(descriptor);
    ::unlink(trial.c_str());
  }
  return "";
}

}  // namespace threelink_tasks
