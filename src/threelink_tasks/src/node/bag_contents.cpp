#include "bag_contents.hpp"

#include <algorithm>

#include <fmt/format.h>

namespace threelink_tasks {
namespace {

constexpr std::uint64_t kFnvBasis = 0xcbf29ce484222325, kFnvPrime = 0x100000001b3;

}  // namespace

void BagContents::add(const std::string& topic, const ros::Time& time, const std::uint8_t* data,
                      std::size_t size) {
  std::uint64_t hash = (kFnvBasis ^ time.toNSec()) * kFnvPrime;
  for (std::size_t i = 0; i < size; ++i) hash = (hash ^ data[i]) * kFnvPrime;
  Topic& entry = topics_[topic];
  ++entry.messages;
  entry.checksum += hash;
  last_ = std::max(last_, time);
}

std::string BagContents::text() const {
  std::string text;
  for (const auto& [name, topic] : topics_)
    text += fmt::format("{}: {} {:016x}\n", name, topic.messages, topic.checksum);
  return text;
}

std::uint64_t BagContents::messages() const {
  std::uint64_t sum = 0;
  for (const auto& [name, topic] : topics_) sum += topic.messages;
  return sum;
}

}  // namespace threelink_tasks
