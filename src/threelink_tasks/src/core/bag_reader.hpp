// A whole bag: the one way in which the programs of this package read one.
//
// The libraries that read bags believe the lengths that a file states, and end the program where
// they lie. So nothing is believed here that the file does not say twice: the messages in its
// chunks must be those of its index, connection for connection and time for time, its connections
// the same in both places, and no byte may be left over. Other readers then see the same messages,
// whichever of the two they go by.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "bag_record.hpp"

namespace threelink_tasks {

struct BagTime {
  std::uint32_t seconds = 0, nanoseconds = 0;

  bool operator==(const BagTime& other) const {
    return seconds == other.seconds && nanoseconds == other.nanoseconds;
  }
  bool operator<(const BagTime& other) const {
    return std::tie(seconds, nanoseconds) < std::tie(other.seconds, other.nanoseconds);
  }
};

struct BagConnection {
  std::string topic;
  std::string type;
  std::string md5sum;
  std::string definition;
};

struct BagMessage {
  const BagConnection* connection;
  BagTime time;
  std::string_view data;
};

class BagReader {
 public:
  static constexpr std::size_t kMaxBytes = (std::size_t{1} << 32) - 1;

  // Throws BagError, or another threelink_sim::UsageError; both name the path.
  explicit BagReader(const std::string& path);
  BagReader(const BagReader&) = delete;
  BagReader& operator=(const BagReader&) = delete;

  // In the order of their times, and of the file where these are equal.
  const std::vector<BagMessage>& messages() const { return messages_; }
  std::size_t bytes() const { return bytes_.size(); }

 private:
  struct Record {
    std::size_t at = 0;
    BagFields header;
    std::string_view data;
  };
  struct Stored {  // a message in a chunk
    BagTime time;
    std::uint32_t offset = 0;        // of its record
    std::uint32_t first_offset = 0;  // of the connection records right before it, if there are any
    std::string_view data;

    bool operator<(const Stored& other) const {
      return std::tie(time, offset) < std::tie(other.time, other.offset);
    }
  };
  using Contents = std::map<std::uint32_t, std::vector<Stored>>;  // by connection
  struct Chunk {
    std::size_t at = 0;
    BagTime first, last;
    std::map<std::uint32_t, std::uint32_t> messages;  // by connection
  };
  struct Connection {
    BagFields header, data;
    BagConnection described;
  };

  void read();
  // The next record, which has to be of that kind; `fields`: how many, `op` among them.
  Record next(BagCursor& cursor, BagOp op, std::size_t fields, std::size_t base = 0) const;
  void read_chunk(BagCursor& cursor);
  Contents read_contents(const Record& chunk);
  void check_index(const Record& index, Contents& contents) const;
  void announce(const Record& record);
  std::uint32_t check_connection(const Record& record) const;  // its number
  void check_chunk_info(const Record& record, const Chunk& chunk) const;

  std::string bytes_;
  std::map<std::uint32_t, Connection> connections_;
  std::vector<Chunk> chunks_;
  std::vector<BagMessage> messages_;
};

}  // namespace threelink_tasks
