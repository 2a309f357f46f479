// The bag of one episode while it is written.
#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>

#include <boost/make_shared.hpp>
#include <ros/message_traits.h>
#include <ros/time.h>
#include <rosbag/bag.h>

#include "bag_contents.hpp"

namespace threelink_tasks {

// What the name of an open bag ends with.
constexpr char kActiveSuffix[] = ".active";

// Open, it is named TASK_YYYY-mm-dd-HH-MM-SS_epNNNN.bag.active and locked (flock), so that no other
// recorder takes it for a leftover. rosbag::BagException and std::runtime_error from any member but
// the destructor mean that the file cannot be written on.
class BagFile {
 public:
  // Longest time for which a message stays in memory [s], wall time. Chunks are small, at most
  // 16 KiB, and closed at least this often: that is what survives of a bag if its writer is killed.
  static constexpr std::chrono::milliseconds kFlushPeriod{200};

  BagFile(const std::filesystem::path& folder, const std::string& task, std::uint32_t episode);
  // A new bag with that name when it is closed.
  explicit BagFile(const std::filesystem::path& path);
  // Leaves the file as it is unless close() was called.
  ~BagFile();
  BagFile(const BagFile&) = delete;
  BagFile& operator=(const BagFile&) = delete;

  template <class Message>
  void write(const std::string& topic, const ros::Time& time, const Message& message) {
    bag_->write(topic, time, message);
    contents_.add(topic, time, message);
  }
  // `rosbag play` latches such a message again.
  template <class Message>
  void write_latched(const std::string& topic, const ros::Time& time, const Message& message);

  // Hands what was written to the kernel, if kFlushPeriod has gone by since the last time.
  void flush_if_due();

  // Writes the index and syncs the file. Nothing can be written after that.
  void close();
  // Takes ".active" off the name of a closed bag.
  void rename();

  const std::filesystem::path& path() const { return path_; }           // in the end
  const std::filesystem::path& active_path() const { return active_; }  // until rename()
  const BagContents& contents() const { return contents_; }

 private:
  bool create();
  void open();
  void let_go();

  std::filesystem::path path_;
  std::filesystem::path active_;
  std::unique_ptr<rosbag::Bag> bag_;
  int lock_ = -1;
  BagContents contents_;
  std::chrono::steady_clock::time_point flushed_;
};

// Why no bag can be written in a folder, which is made if it is missing; empty if one can.
std::string why_not_writable(const std::filesystem::path& folder);

template <class Message>
void BagFile::write_latched(const std::string& topic, const ros::Time& time,
                            const Message& message) {
  namespace traits = ros::message_traits;
  bag_->write(topic, time, message,
              boost::make_shared<ros::M_string>(
                  ros::M_string{{"type", traits::datatype<Message>()},
                                {"md5sum", traits::md5sum<Message>()},
                                {"message_definition", traits::definition<Message>()},
                                {"latching", "1"}}));
  contents_.add(topic, time, message);
}

}  // namespace threelink_tasks
