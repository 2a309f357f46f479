// What a bag holds, topic by topic: how many messages, and a checksum of them.
//
// The recorder ends each bag with it, so that a message that is lost or changed later is found,
// also one that nothing else could tell. A checksum guards against accidents, not against forgers.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include <ros/serialization.h>
#include <ros/time.h>

namespace threelink_tasks {

class BagContents {
 public:
  // data: the message as it is stored; time: that in the bag.
  void add(const std::string& topic, const ros::Time& time, const std::uint8_t* data,
           std::size_t size);
  template <class Message>
  void add(const std::string& topic, const ros::Time& time, const Message& message);

  // "TOPIC: MESSAGES CHECKSUM" of each topic, sorted, a line each.
  std::string text() const;
  std::uint64_t messages() const;
  ros::Time last() const { return last_; }  // time of the latest message

 private:
  struct Topic {
    std::uint64_t messages = 0;
    // Sum over the messages, in whatever order they are read, of 64-bit FNV-1a of time and data.
    std::uint64_t checksum = 0;
  };

  std::map<std::string, Topic> topics_;
  ros::Time last_;
  std::vector<std::uint8_t> buffer_;
};

template <class Message>
void BagContents::add(const std::string& topic, const ros::Time& time, const Message& message) {
  namespace serialization = ros::serialization;
  buffer_.resize(serialization::serializationLength(message));
  serialization::OStream stream(buffer_.data(), static_cast<std::uint32_t>(buffer_.size()));
  serialization::serialize(stream, message);
  add(topic, time, buffer_.data(), buffer_.size());
}

}  // namespace threelink_tasks
