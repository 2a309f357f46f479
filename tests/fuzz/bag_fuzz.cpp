// A whole bag: its messages point into it, or it is refused.
#include "bag_reader.hpp"
#include "fuzz.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using threelink_tasks::BagReader;
  static const threelink_fuzz::ScratchFolder folder;
  static volatile char seen;
  const std::string path = folder.file("some.bag", data, size);
  threelink_fuzz::value_or<threelink_sim::UsageError>([&] {
    const BagReader reader(path);
    std::size_t bytes = 0;
    for (const auto& message : reader.messages()) {
      bytes += message.data.size();
      for (const char byte : message.data) seen = byte;  // each can be read
    }
    threelink_fuzz::require(bytes <= size, "messages that are not in the bag");
  });
  return 0;
}
