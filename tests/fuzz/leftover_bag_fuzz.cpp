// A bag that its recorder left open: what could be read of it becomes a bag that is whole.
#include <filesystem>

#include <ros/exception.h>
#include <rosbag/bag.h>
#include <rosbag/view.h>

#include "fuzz.hpp"
#include "leftover_bag.hpp"

// A bag on which writing failed is leaked on purpose: its destructor could end the program.
extern "C" const char* __lsan_default_suppressions() { return "leak:threelink_tasks::BagFile::"; }

constexpr char kName[] = "pursuit_2026-01-31-23-59-59_ep0001";

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const threelink_fuzz::ScratchFolder folder;
  std::filesystem::remove(folder.path() / "episodes.csv");
  std::filesystem::remove(folder.path() / (std::string(kName) + "_recovered.bag"));
  const std::string path = folder.file(std::string(kName) + ".bag.active", data, size);
  threelink_fuzz::value_or<std::runtime_error>([&] {
    const auto row = threelink_tasks::recover_leftover(path);
    if (!row) return;
    const rosbag::Bag bag((folder.path() / row->bag).string());
    threelink_fuzz::require(rosbag::View(bag).size() == row->messages, "messages were lost");
  });
  return 0;
}
