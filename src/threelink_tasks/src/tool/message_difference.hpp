// Two messages of one type, compared to the bit.
#pragma once

#include <optional>
#include <sstream>
#include <string>
#include <vector>

#include <ros/message_operations.h>
#include <ros/serialization.h>

namespace threelink_tasks {

struct FieldDifference {
  std::string field;               // "header.stamp", "alpha[1]", ...
  std::string recorded, replayed;  // 17 significant digits; empty where there is none
};

// The first line in which two texts differ, each as a message prints itself: "NAME: VALUE", what a
// field consists of indented below it.
FieldDifference first_differing_line(const std::string& recorded, const std::string& replayed);

template <class Message>
std::vector<std::uint8_t> bytes_of(const Message& message) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(message));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, message);
  return bytes;
}

template <class Message>
std::string text_of(const Message& message) {
  std::ostringstream stream;
  stream.precision(17);
  ros::message_operations::Printer<Message>::stream(stream, "", message);
  return stream.str();
}

// Nothing if the two have the same bytes.
template <class Message>
std::optional<FieldDifference> first_difference(const Message& recorded, const Message& replayed) {
  if (bytes_of(recorded) == bytes_of(replayed)) return std::nullopt;
  return first_differing_line(text_of(recorded), text_of(replayed));
}

}  // namespace threelink_tasks
