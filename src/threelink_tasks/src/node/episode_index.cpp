#include "episode_index.hpp"

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <fstream>
#include <sstream>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include "../core/bag_name.hpp"
#include "threelink_sim/files.hpp"

namespace threelink_tasks {
namespace {

using threelink_msgs::Episode;

constexpr char kFile[] = "episodes.csv";
constexpr char kOldHeader[] =
    "episode,bag,task,seed,status,steps,time,distance,mean_speed,policy_sha256,messages,recovered";
constexpr char kHeader[] =
    "episode,bag,task,seed,status,steps,time,distance,mean_speed,policy_sha256,messages,recovered,"
    "missing";
constexpr std::ptrdiff_t kOldCommas = 11;
constexpr std::size_t kMostBytes = std::size_t{1} << 30;

std::string cell(const std::optional<double>& value) {
  return value && std::isfinite(*value) ? fmt::format("{}", *value) : std::string();
}

std::string cell(const std::string& text) { return is_plain_name(text) ? text : std::string(); }

std::string line(const IndexRow& row) {
  return fmt::format("{},{},{},{},{},{},{},{},{},{},{},{},{}\n", row.episode,
                     is_bag_name(row.bag) ? row.bag : "", cell(row.task), row.seed, row.status,
                     row.steps, cell(row.time), cell(row.distance), cell(row.mean_speed),
                     cell(row.policy_sha256), row.messages, row.recovered ? "yes" : "no",
                     row.missing);
}

// A file that is open, and locked against other processes until it is closed.
class LockedFile {
 public:
  explicit LockedFile(const std::filesystem::path& path) : path_(path) {
    do {
      if (descriptor_ >= 0) close(descriptor_);
      descriptor_ = open(path.c_str(), O_RDWR | O_CREAT | O_NOFOLLOW | O_CLOEXEC, 0644);
      if (descriptor_ < 0) fail("open");
      if (flock(descriptor_, LOCK_EX) != 0) {
        const int error = errno;
        close(descriptor_);
        errno = error;
        fail("lock");
      }
    } while (!is_there());  // another recorder may have put a new one in its place
  }
  ~LockedFile() { close(descriptor_); }
  LockedFile(const LockedFile&) = delete;
  LockedFile& operator=(const LockedFile&) = delete;

  // Position after the last whole line: what a power cut left of a line is written over.
  off_t end_of_lines() const {
    off_t end = lseek(descriptor_, 0, SEEK_END);
    char last = '\n';
    while (end > 0 && pread(descriptor_, &last, 1, end - 1) == 1 && last != '\n') --end;
    return end;
  }

  void replace_from(off_t position, const std::string& text) {
    if (ftruncate(descriptor_, position) != 0) fail("shorten");
    if (pwrite(descriptor_, text.data(), text.size(), position) !=
            static_cast<ssize_t>(text.size()) ||
        fsync(descriptor_) != 0) {
      const int error = errno;
      if (ftruncate(descriptor_, position) != 0) fail("shorten");
      errno = error;
      fail("write");
    }
  }

  // That many bytes from the start.
  std::string head(std::size_t size) const {
    std::string bytes(size, '\0');
    const ssize_t got = pread(descriptor_, bytes.data(), size, 0);
    bytes.resize(got > 0 ? static_cast<std::size_t>(got) : 0);
    return bytes;
  }

 private:
  bool is_there() const {
    struct stat open {
    }, there{};
    return fstat(descriptor_, &open) == 0 && lstat(path_.c_str(), &there) == 0 &&
           open.st_ino == there.st_ino && open.st_dev == there.st_dev;
  }

  [[noreturn]] void fail(const char* what) const {
    throw std::runtime_error(
        fmt::format("cannot {} {}: {}", what, path_.string(), std::strerror(errno)));
  }

  std::filesystem::path path_;
  int descriptor_ = -1;
};

std::ptrdiff_t commas_in(const std::string& line) {
  return std::count(line.begin(), line.end(), ',');
}

// The text of an older version, with the column that it lacks.
std::string with_last_column(const std::string& text) {
  std::istringstream lines(text);
  std::string line, result = std::string(kHeader) + "\n";
  std::getline(lines, line);
  while (std::getline(lines, line)) result += line + (commas_in(line) == kOldCommas ? ",\n" : "\n");
  return result;
}

}  // namespace

std::string status_name(std::uint8_t status) {
  switch (status) {
    case Episode::STARTED:
      return "started";
    case Episode::CAPTURED:
      return "captured";
    case Episode::TIMED_OUT:
      return "timed_out";
    default:
      return "aborted";
  }
}

void EpisodeStory::hear(const Episode& message) {
  row_.episode = message.episode;
  row_.task = message.task;
  row_.seed = message.seed;
  row_.policy_sha256 = message.policy_sha256;
  ended_ = message.status != Episode::STARTED;
  if (!ended_) return;
  row_.status = status_name(message.status);
  row_.steps = message.step;
  row_.time = message.time;
  row_.distance = message.distance;
  row_.mean_speed = message.mean_speed;
}

void EpisodeStory::hear(const threelink_msgs::SwimmerState& message) {
  if (message.step > due_) row_.missing += message.step - due_;
  due_ = std::max(due_, message.step + 1);
  if (!ended_) row_.steps = message.step;
}

void EpisodeStory::hear(const threelink_msgs::Observation& message) {
  if (!ended_) row_.distance = message.distance;
}

IndexRow EpisodeStory::row() const {
  IndexRow row = row_;
  if (!ended_) row.status = status_name(Episode::ABORTED);
  return row;
}

void append_to_index(const std::filesystem::path& folder, const IndexRow& row) {
  LockedFile file(folder / kFile);
  const off_t end = file.end_of_lines();
  if (end == 0) {
    file.replace_from(0, std::string(kHeader) + "\n" + line(row));
  } else if (file.head(sizeof kOldHeader) == std::string(kOldHeader) + "\n") {
    const std::string text = threelink_sim::read_file(folder / kFile, kMostBytes);
    threelink_sim::write_file(folder / kFile, with_last_column(text.substr(0, end)) + line(row));
  } else {
    file.replace_from(end, line(row));
  }
}

std::vector<std::string> indexed_bags(const std::filesystem::path& folder) {
  std::vector<std::string> names;
  std::ifstream file(folder / kFile);
  std::string row, episode, bag;
  std::getline(file, row);  // the header
  while (std::getline(file, row) && !file.eof()) {
    const std::ptrdiff_t commas = commas_in(row);
    if ((commas != kOldCommas && commas != kOldCommas + 1) || row.find('"') != std::string::npos)
      continue;
    std::istringstream cells(row);
    if (std::getline(cells, episode, ',') && std::getline(cells, bag, ',')) names.push_back(bag);
  }
  return names;
}

}  // namespace threelink_tasks
