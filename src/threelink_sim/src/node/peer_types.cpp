#include "threelink_sim/node/peer_types.hpp"

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <map>
#include <set>
#include <thread>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <ros/console.h>
#include <ros/this_node.h>
#include <ros/topic_manager.h>

#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/mutex.hpp"

namespace threelink_sim {
namespace {

constexpr std::chrono::seconds kPeriod(2);
constexpr std::size_t kMostPublishers = 20;  // of a topic, that are asked in one round

Mutex mutex;
std::map<std::string, TopicType> expected GUARDED_BY(mutex);     // by topic
std::map<std::string, std::string> conflicts GUARDED_BY(mutex);  // likewise

bool has_publisher(const std::string& topic) {
  return ros::TopicManager::instance()->getNumPublishers(topic) > 0;
}

std::string text_of(const TopicType& type) {
  return fmt::format("{} (md5sum {})", excerpt(type.datatype, 200), excerpt(type.md5sum, 200));
}

}  // namespace

void expect_type(const std::string& topic, const TopicType& type) {
  const Lock lock(mutex);
  expected[topic] = type;
}

std::string other_type_on(const std::string& topic) {
  if (has_publisher(topic)) return "";
  const Lock lock(mutex);
  const auto found = conflicts.find(topic);
  return found == conflicts.end() ? "" : found->second;
}

class PeerTypes::Watch {
 public:
  Watch() : thread_([this] { run(); }) {}
  ~Watch() {
    {
      const Lock lock(wake_mutex_);
      ending_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }

 private:
  bool ending() {
    const Lock lock(wake_mutex_);
    return ending_;
  }

  void run() {
    const auto ending = [this]() REQUIRES(wake_mutex_) { return ending_; };
    Lock lock(wake_mutex_);
    while (!wake_.wait_for(lock, kPeriod, ending)) {
      lock.unlock();
      std::map<std::string, TopicType> topics;
      {
        const Lock guard(mutex);
        topics = expected;
      }
      for (const auto& [topic, type] : topics) {
        if (has_publisher(topic))
          waiting_.erase(topic);
        else
          look_at(topic, type);
      }
      lock.lock();
    }
  }

  void look_at(const std::string& topic, const TopicType& ours) {
    std::vector<std::string> publishers = publishers_of(topic);
    publishers.resize(std::min(publishers.size(), kMostPublishers));
    // Connections take their time: only a publisher that is not connected two times in a row is
    // asked.
    if (publishers.empty()) {
      waiting_.erase(topic);
      const Lock lock(mutex);
      conflicts.erase(topic);
      return;
    }
    if (waiting_.insert(topic).second) return;
    std::string conflict;
    for (const std::string& node : publishers) {
      if (node == ros::this_node::getName() || ending()) continue;
      const TopicType theirs = type_of(node, topic);
      if (theirs.datatype.empty() ||
          (theirs.datatype == ours.datatype && theirs.md5sum == ours.md5sum))
        continue;
      conflict = fmt::format("{} publishes {} as {}, and this node takes {}", excerpt(node, 200),
                             topic, text_of(theirs), text_of(ours));
      if (told_.size() < kMostTold && told_.insert(conflict).second)
        ROS_ERROR("%s; nothing of it is heard", conflict.c_str());
    }
    const Lock lock(mutex);
    conflicts[topic] = conflict;
  }

  // Not asked again at once: each question is a connection that the publisher may complain about.
  TopicType type_of(const std::string& node, const std::string& topic) {
    const auto now = std::chrono::steady_clock::now();
    if (answers_.size() > kMostAnswers) answers_.clear();
    Answer& answer = answers_[{node, topic}];
    if (answer.type.datatype.empty() || now - answer.time > kFresh)
      answer = {type_at_publisher(node, topic), now};
    return answer.type;
  }

  static constexpr std::size_t kMostTold = 100, kMostAnswers = 1000;
  static constexpr std::chrono::seconds kFresh{60};

  struct Answer {
    TopicType type;
    std::chrono::steady_clock::time_point time;
  };
  std::map<std::pair<std::string, std::string>, Answer> answers_;
  std::set<std::string> told_, waiting_;
  Mutex wake_mutex_;
  std::condition_variable_any wake_;
  bool ending_ GUARDED_BY(wake_mutex_) = false;
  std::thread thread_;  // last: it uses the others
};

PeerTypes::PeerTypes() : watch_(std::make_unique<Watch>()) {}
PeerTypes::~PeerTypes() = default;

}  // namespace threelink_sim
