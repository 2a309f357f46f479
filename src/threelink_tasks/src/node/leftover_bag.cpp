// Reading a bag that was never closed.
//
// Without compression a chunk is a bracket around records. Going into every chunk, also one whose
// size was never filled in, gives all messages that reached the file.
#include "leftover_bag.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <optional>
#include <stdexcept>

#include <fcntl.h>
#include <fmt/format.h>
#include <ros/serialization.h>
#include <sys/file.h>
#include <topic_tools/shape_shifter.h>
#include <unistd.h>

#include "../core/bag_name.hpp"
#include "../core/bag_record.hpp"
#include "bag_file.hpp"
#include "threelink_sim/files.hpp"

namespace threelink_tasks {
namespace {

namespace fs = std::filesystem;

const std::string kRecovered = "_recovered";
constexpr std::size_t kMostBytes = (std::size_t{1} << 32) - 1;
constexpr std::uint32_t kSecond = 1000000000;  // [ns]

// The lock that a recorder holds on a bag that it writes.
class Lock {
 public:
  explicit Lock(const fs::path& path)
      : descriptor_(::open(path.c_str(), O_RDONLY | O_NOFOLLOW | O_NONBLOCK | O_CLOEXEC)),
        held_(descriptor_ >= 0 && flock(descriptor_, LOCK_EX | LOCK_NB) == 0) {}
  ~Lock() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;
  explicit operator bool() const { return held_; }

 private:
  int descriptor_;
  bool held_;
};

struct Connection {
  std::string topic;
  topic_tools::ShapeShifter message;
};

using Take =
    std::function<void(const std::string&, const ros::Time&, const topic_tools::ShapeShifter&)>;

std::string text(const BagFields& fields, const char* name) {
  return std::string(fields.text(name));
}

// Calls `take` with every whole message of a bag without an index, in the order of the file.
void read_messages(const fs::path& path, const Take& take) {
  const std::string bytes = threelink_sim::read_file(path, kMostBytes);
  if (bytes.compare(0, kBagMagic.size(), kBagMagic) != 0)
    throw BagError(path.string() + " is no bag of format 2.0");
  BagCursor cursor(bytes, kBagMagic.size());
  std::map<std::uint32_t, Connection> connections;
  while (const auto header = cursor.take_sized()) {
    const BagFields fields = BagFields::parse(*header).value_or(BagFields());
    if (fields.op() == BagOp::kChunk) {
      cursor.take_integer<std::uint32_t>();
      continue;
    }
    const auto data = cursor.take_sized();
    if (!data) return;
    const auto id = fields.integer<std::uint32_t>("conn");
    if (!id) continue;
    if (fields.op() == BagOp::kConnection) {
      const BagFields type = BagFields::parse(*data).value_or(BagFields());
      Connection& connection = connections[*id];
      connection.topic = text(fields, "topic");
      connection.message.morph(text(type, "md5sum"), text(type, "type"),
                               text(type, "message_definition"), text(type, "latching"));
    } else if (fields.op() == BagOp::kMessage && connections.count(*id) != 0) {
      const auto time = fields.integer<std::uint64_t>("time").value_or(0);
      const auto seconds = static_cast<std::uint32_t>(time);
      const auto nanoseconds = static_cast<std::uint32_t>(time >> 32);
      // No recorder writes a message without bytes, and the library cannot.
      if (time == 0 || nanoseconds >= kSecond || data->empty()) continue;  // a damaged one
      // The stream writes nothing.
      auto* content = reinterpret_cast<std::uint8_t*>(const_cast<char*>(data->data()));
      ros::serialization::IStream stream(content, static_cast<std::uint32_t>(data->size()));
      const Connection& connection = connections[*id];
      topic_tools::ShapeShifter message = connection.message;
      message.read(stream);
      take(connection.topic, ros::Time(seconds, nanoseconds), message);
    }
  }
}

void tell(EpisodeStory& story, const topic_tools::ShapeShifter& message) {
  const auto tell_as = [&](auto type) {
    using Message = decltype(type);
    if (message.getDataType() != ros::message_traits::datatype<Message>()) return;
    try {
      story.hear(*message.instantiate<Message>());
    } catch (const std::exception&) {  // it is damaged, and tells nothing
    }
  };
  tell_as(threelink_msgs::Episode());
  tell_as(threelink_msgs::SwimmerState());
  tell_as(threelink_msgs::Observation());
}

}  // namespace

std::vector<fs::path> leftover_bags(const fs::path& folder) {
  std::vector<fs::path> leftovers;
  std::error_code unreadable;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder, unreadable)) {
    const fs::path& path = entry.path();
    if (path.extension() != kActiveSuffix || !is_bag_name(path.stem().string())) continue;
    // What an interrupted recovery has written is written anew from its leftover.
    const std::string name = path.stem().stem();
    if (name.size() > kRecovered.size() &&
        name.compare(name.size() - kRecovered.size(), kRecovered.size(), kRecovered) == 0)
      continue;
    if (fs::is_regular_file(entry.symlink_status()) && Lock(path)) leftovers.push_back(path);
  }
  std::sort(leftovers.begin(), leftovers.end());
  return leftovers;
}

std::optional<IndexRow> recover_leftover(const fs::path& leftover) {
  const Lock lock(leftover);  // until it is gone, so that no other recorder recovers it as well
  if (!lock) return std::nullopt;
  const fs::path folder = leftover.parent_path();
  const std::string name = leftover.stem().stem();  // without .bag.active
  const std::vector<std::string> listed = indexed_bags(folder);
  const auto is_listed = [&](const std::string& bag) {
    return std::find(listed.begin(), listed.end(), bag) != listed.end();
  };
  if (fs::is_empty(leftover)) {  // its recorder died before the first message
    fs::remove(leftover);
    return std::nullopt;
  }
  if (is_listed(name + ".bag")) {  // ... or after the last one
    fs::rename(leftover, folder / (name + ".bag"));
    return std::nullopt;
  }
  EpisodeStory story;
  IndexRow row;
  std::error_code absent;
  fs::remove(folder / (name + kRecovered + ".bag" + kActiveSuffix), absent);
  BagFile bag(folder / (name + kRecovered + ".bag"));
  try {
    read_messages(leftover, [&](const std::string& topic, const ros::Time& time,
                                const topic_tools::ShapeShifter& message) {
      bag.write(topic, time, message);
      tell(story, message);
    });
    bag.close();
    row = story.row();
    row.bag = bag.path().filename();
    row.messages = bag.contents().messages();
    row.recovered = true;
    if (!is_listed(row.bag)) append_to_index(folder, row);
    bag.rename();
  } catch (const std::exception&) {
    try {
      bag.close();  // it was perhaps the leftover that was no bag, and then this one need not leak
    } catch (const std::exception&) {
    }
    std::error_code ignored;
    fs::remove(bag.active_path(), ignored);
    throw;
  }
  fs::remove(leftover);
  return row;
}

}  // namespace threelink_tasks
