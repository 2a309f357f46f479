#include "bag_reader.hpp"

#include <algorithm>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "threelink_sim/files.hpp"

namespace threelink_tasks {
namespace {

constexpr std::size_t kEntrySize = 12;  // of an index record: time, offset
constexpr std::size_t kCountSize = 8;   // of a chunk info record: connection, number of messages
constexpr std::uint32_t kVersion = 1;   // of index and chunk info records

[[noreturn]] void damaged(std::size_t at, const std::string& what) {
  throw BagError(fmt::format("it is damaged at byte {}: {}", at, what));
}

[[noreturn]] void cut_off(std::size_t at) {
  throw BagError(
      fmt::format("it is cut off, or was not closed (byte {}): `rosbag reindex` may mend it", at));
}

template <class Integer>
Integer required(const BagFields& fields, std::string_view name, std::size_t at) {
  const std::optional<Integer> value = fields.integer<Integer>(name);
  if (!value) damaged(at, fmt::format("a header without a proper `{}`", name));
  return *value;
}

BagTime time_of(const char* bytes, std::size_t at) {
  const BagTime time{bag_integer<std::uint32_t>(bytes), bag_integer<std::uint32_t>(bytes + 4)};
  if (time.nanoseconds >= 1000000000) damaged(at, "a time that is none");
  return time;
}

BagTime required_time(const BagFields& fields, std::string_view name, std::size_t at) {
  if (fields.text(name).size() != 8)
    damaged(at, fmt::format("a header without a proper `{}`", name));
  return time_of(fields.text(name).data(), at);
}

}  // namespace

BagReader::BagReader(const std::string& path) : bytes_(threelink_sim::read_input(path, kMaxBytes)) {
  try {
    read();
  } catch (const BagError& error) {
    throw BagError(path + ": " + error.what());
  }
  std::stable_sort(messages_.begin(), messages_.end(),
                   [](const BagMessage& a, const BagMessage& b) { return a.time < b.time; });
}

void BagReader::read() {
  if (bytes_.empty()) throw BagError("it is empty");
  if (bytes_.compare(0, kBagMagic.size(), kBagMagic) != 0)
    throw BagError("it is no bag of format 2.0");
  BagCursor cursor(bytes_, kBagMagic.size());
  const Record header = next(cursor, BagOp::kBagHeader, 4);
  const auto index = required<std::uint64_t>(header.header, "index_pos", header.at);
  const auto connections = required<std::uint32_t>(header.header, "conn_count", header.at);
  const auto chunks = required<std::uint32_t>(header.header, "chunk_count", header.at);
  if (header.data.find_first_not_of(' ') != std::string_view::npos)
    damaged(header.at, "the padding of its header");
  if (index == 0 || index > bytes_.size()) cut_off(bytes_.size());
  while (cursor.at() < index) read_chunk(cursor);
  if (cursor.at() != index) damaged(cursor.at(), "a record that reaches into the index");
  std::set<std::uint32_t> listed;
  for (std::uint32_t i = 0; i < connections; ++i)
    listed.insert(check_connection(next(cursor, BagOp::kConnection, 3)));
  if (connections != connections_.size() || listed.size() != connections ||
      chunks != chunks_.size())
    damaged(header.at, "numbers of connections and chunks that are not those in the file");
  for (const Chunk& chunk : chunks_) check_chunk_info(next(cursor, BagOp::kChunkInfo, 6), chunk);
  if (!cursor.at_end()) damaged(cursor.at(), "bytes after its end");
}

BagReader::Record BagReader::next(BagCursor& cursor, BagOp op, std::size_t fields,
                                  std::size_t base) const {
  Record record;
  record.at = base + cursor.at();
  const auto header = cursor.take_sized();
  const auto data = header ? cursor.take_sized() : std::nullopt;
  if (!data) {
    if (base == 0) cut_off(record.at);
    damaged(record.at, "a record that is longer than its chunk");
  }
  const auto parsed = BagFields::parse(*header);
  if (!parsed) damaged(record.at, "what should be the header of a record");
  if (parsed->op() != op || parsed->size() != fields)
    damaged(record.at, "a record of another kind than belongs there");
  record.header = *parsed;
  record.data = *data;
  return record;
}

// A chunk, and the index of it that follows.
void BagReader::read_chunk(BagCursor& cursor) {
  const Record chunk = next(cursor, BagOp::kChunk, 3);
  const std::string_view compression = chunk.header.text("compression");
  if (compression == "bz2" || compression == "lz4")
    throw BagError(fmt::format("it is compressed ({}): `rosbag decompress` first", compression));
  if (compression != "none" ||
      required<std::uint32_t>(chunk.header, "size", chunk.at) != chunk.data.size())
    damaged(chunk.at, "the header of a chunk");
  Contents contents = read_contents(chunk);
  Chunk summary;
  summary.at = chunk.at;
  for (auto& [id, messages] : contents) {
    const auto [first, last] = std::minmax_element(messages.begin(), messages.end());
    if (summary.messages.empty() || first->time < summary.first) summary.first = first->time;
    if (summary.messages.empty() || summary.last < last->time) summary.last = last->time;
    summary.messages[id] = static_cast<std::uint32_t>(messages.size());
  }
  chunks_.push_back(summary);
  for (std::size_t i = 0; i < summary.messages.size(); ++i)
    check_index(next(cursor, BagOp::kIndex, 4), contents);
}

BagReader::Contents BagReader::read_contents(const Record& chunk) {
  Contents contents;
  const std::size_t base = static_cast<std::size_t>(chunk.data.data() - bytes_.data());
  BagCursor cursor(chunk.data);
  std::optional<std::uint32_t> announced;  // offset of the first of connection records in a row
  while (!cursor.at_end()) {
    const auto offset = static_cast<std::uint32_t>(cursor.at());
    BagCursor ahead = cursor;
    const auto header = ahead.take_sized();
    const auto fields = header ? BagFields::parse(*header) : std::nullopt;
    if (fields && fields->op() == BagOp::kConnection) {
      announce(next(cursor, BagOp::kConnection, 3, base));
      if (!announced) announced = offset;
      continue;
    }
    const Record record = next(cursor, BagOp::kMessage, 3, base);
    const auto id = required<std::uint32_t>(record.header, "conn", record.at);
    const auto connection = connections_.find(id);
    if (connection == connections_.end())
      damaged(record.at, "a message of a connection that was not announced");
    const BagTime time = required_time(record.header, "time", record.at);
    contents[id].push_back({time, offset, announced.value_or(offset), record.data});
    messages_.push_back({&connection->second.described, time, record.data});
    announced.reset();
  }
  return contents;
}

void BagReader::check_index(const Record& index, Contents& contents) const {
  const auto id = required<std::uint32_t>(index.header, "conn", index.at);
  const auto count = required<std::uint32_t>(index.header, "count", index.at);
  const auto found = contents.find(id);
  if (found == contents.end() ||
      required<std::uint32_t>(index.header, "ver", index.at) != kVersion ||
      found->second.size() != count || index.data.size() != kEntrySize * count)
    damaged(index.at, "an index that is not that of its chunk");
  std::vector<Stored>& messages = found->second;
  std::sort(messages.begin(), messages.end());
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const char* entry = index.data.data() + kEntrySize * i;
    const auto offset = bag_integer<std::uint32_t>(entry + 8);
    if (!(time_of(entry, index.at) == messages[i].time))
      damaged(index.at, "the index gives a message another time than its record");
    if (offset != messages[i].offset && offset != messages[i].first_offset)
      damaged(index.at, "the index gives a message another place than it has");
  }
  contents.erase(found);  // so that no other index can be that of the same connection
}

void BagReader::announce(const Record& record) {
  const auto id = required<std::uint32_t>(record.header, "conn", record.at);
  const auto data = BagFields::parse(record.data);
  if (!data || !record.header.has("topic")) damaged(record.at, "the record of a connection");
  if (connections_.count(id) != 0) {
    check_connection(record);
    return;
  }
  const std::string topic(record.header.text("topic"));
  for (const char* name : {"type", "md5sum", "message_definition"})
    if (!data->has(name)) damaged(record.at, fmt::format("a connection without `{}`", name));
  if (data->has("topic") && data->text("topic") != topic)
    damaged(record.at, "a connection of two topics");
  connections_[id] = {record.header,
                      *data,
                      {topic, std::string(data->text("type")), std::string(data->text("md5sum")),
                       std::string(data->text("message_definition"))}};
}

std::uint32_t BagReader::check_connection(const Record& record) const {
  const auto id = required<std::uint32_t>(record.header, "conn", record.at);
  const auto known = connections_.find(id);
  const auto data = BagFields::parse(record.data);
  if (known == connections_.end() || !data || !(known->second.header == record.header) ||
      !(known->second.data == *data))
    damaged(record.at, "a connection that is not the one before its messages");
  return id;
}

void BagReader::check_chunk_info(const Record& record, const Chunk& chunk) const {
  const BagFields& header = record.header;
  bool equal = required<std::uint32_t>(header, "ver", record.at) == kVersion &&
               required<std::uint64_t>(header, "chunk_pos", record.at) == chunk.at &&
               required_time(header, "start_time", record.at) == chunk.first &&
               required_time(header, "end_time", record.at) == chunk.last &&
               required<std::uint32_t>(header, "count", record.at) == chunk.messages.size() &&
               record.data.size() == kCountSize * chunk.messages.size();
  std::map<std::uint32_t, std::uint32_t> messages;
  for (std::size_t i = 0; equal && i < chunk.messages.size(); ++i) {
    const char* pair = record.data.data() + kCountSize * i;
    messages[bag_integer<std::uint32_t>(pair)] = bag_integer<std::uint32_t>(pair + 4);
  }
  equal = equal && messages == chunk.messages;
  if (!equal) damaged(record.at, "a summary that is not that of its chunk");
}

}  // namespace threelink_tasks
