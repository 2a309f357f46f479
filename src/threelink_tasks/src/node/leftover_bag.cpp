// Reading a bag that was never closed: format 2.0, http://wiki.ros.org/Bags/Format/2.0
//
// Without compression a chunk is a bracket around records. Going into every chunk, also one whose
// size was never filled in, gives all messages that reached the file.
#include "leftover_bag.hpp"

#include <algorithm>
#include <cstring>
#include <fstream>
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

#include "bag_file.hpp"

namespace threelink_tasks {
namespace {

namespace fs = std::filesystem;

const std::string kRecovered = "_recovered";
constexpr char kMagic[] = "#ROSBAG V2.0\n";
constexpr std::uint8_t kMessageData = 0x02, kChunk = 0x05, kConnection = 0x07;

using Fields = std::map<std::string, std::string>;

class RecordReader {
 public:
  explicit RecordReader(const fs::path& path)
      : file_(path, std::ios::binary), left_(fs::file_size(path)) {
    if (read(std::strlen(kMagic)) != kMagic)
      throw std::runtime_error(fmt::format("{} is not a bag of format 2.0", path.string()));
  }

  // A length and that many bytes; nothing where the file ends before them.
  std::optional<std::string> read_sized() {
    const std::optional<std::uint32_t> size = read_size();
    return size ? read(*size) : std::nullopt;
  }

  std::optional<std::uint32_t> read_size() {
    const std::optional<std::string> bytes = read(sizeof(std::uint32_t));
    if (!bytes) return std::nullopt;
    std::uint32_t size;
    std::memcpy(&size, bytes->data(), sizeof size);
    return size;
  }

 private:
  std::optional<std::string> read(std::uintmax_t size) {
    if (size > left_) return std::nullopt;
    left_ -= size;
    std::string bytes(size, '\0');
    if (!file_.read(bytes.data(), static_cast<std::streamsize>(size))) return std::nullopt;
    return bytes;
  }

  std::ifstream file_;
  std::uintmax_t left_;
};

// Fields of a header: length, name, '=', value. What is no header gives no fields.
Fields fields_of(const std::string& header) {
  Fields fields;
  std::size_t at = 0;
  while (at + sizeof(std::uint32_t) <= header.size()) {
    std::uint32_t size;
    std::memcpy(&size, header.data() + at, sizeof size);
    at += sizeof size;
    if (size > header.size() - at) return {};
    const std::string field = header.substr(at, size);
    const std::size_t equals = field.find('=');
    if (equals == std::string::npos) return {};
    fields[field.substr(0, equals)] = field.substr(equals + 1);
    at += size;
  }
  return fields;
}

// An integer field; 0, which is no op and no connection of ours that was not announced, without it.
template <class Integer>
Integer integer(const Fields& fields, const std::string& name) {
  Integer value = 0;
  const auto field = fields.find(name);
  if (field != fields.end() && field->second.size() == sizeof value)
    std::memcpy(&value, field->second.data(), sizeof value);
  return value;
}

struct Connection {
  std::string topic;
  topic_tools::ShapeShifter message;
};

// Calls `take` with every whole message of a bag without an index, in the order of the file.
void read_messages(const fs::path& path,
                   const std::function<void(const std::string&, const ros::Time&,
                                            const topic_tools::ShapeShifter&)>& take) {
  RecordReader reader(path);
  std::map<std::uint32_t, Connection> connections;
  while (const std::optional<std::string> header = reader.read_sized()) {
    Fields fields = fields_of(*header);
    const auto op = integer<std::uint8_t>(fields, "op");
    if (op == kChunk) {
      reader.read_size();
      continue;
    }
    std::optional<std::string> data = reader.read_sized();
    if (!data) return;
    const auto id = integer<std::uint32_t>(fields, "conn");
    if (op == kConnection) {
      Fields type = fields_of(*data);
      Connection& connection = connections[id];
      connection.topic = fields["topic"];
      connection.message.morph(type["md5sum"], type["type"], type["message_definition"],
                               type["latching"]);
    } else if (op == kMessageData && connections.count(id) != 0) {
      const auto time = integer<std::uint64_t>(fields, "time");
      auto* bytes = reinterpret_cast<std::uint8_t*>(data->data());
      ros::serialization::IStream stream(bytes, static_cast<std::uint32_t>(data->size()));
      Connection& connection = connections[id];
      connection.message.read(stream);
      take(connection.topic,
           ros::Time(static_cast<std::uint32_t>(time), static_cast<std::uint32_t>(time >> 32)),
           connection.message);
    }
  }
}

void tell(EpisodeStory& story, const topic_tools::ShapeShifter& message) {
  const auto tell_as = [&](auto type) {
    using Message = decltype(type);
    if (message.getDataType() == ros::message_traits::datatype<Message>())
      story.hear(*message.instantiate<Message>());
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
    const fs::path path = entry.path();
    if (path.extension() != kActiveSuffix || path.stem().extension() != ".bag") continue;
    // What an interrupted recovery has written is written anew from its leftover.
    const std::string name = path.stem().stem();
    if (name.size() > kRecovered.size() &&
        name.compare(name.size() - kRecovered.size(), kRecovered.size(), kRecovered) == 0)
      continue;
    const int descriptor = ::open(path.c_str(), O_RDONLY | O_CLOEXEC);
    if (descriptor < 0) continue;
    if (flock(descriptor, LOCK_EX | LOCK_NB) == 0) leftovers.push_back(path);
    ::close(descriptor);
  }
  std::sort(leftovers.begin(), leftovers.end());
  return leftovers;
}

std::optional<IndexRow> recover_leftover(const fs::path& leftover) {
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
    std::error_code ignored;
    fs::remove(bag.active_path(), ignored);
    throw;
  }
  fs::remove(leftover);
  return row;
}

}  // namespace threelink_tasks
