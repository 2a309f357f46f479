// episodes.csv: rows that are there stay when one is added, and the new one is found.
#include <algorithm>

#include "episode_index.hpp"
#include "fuzz.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace threelink_tasks;
  static const threelink_fuzz::ScratchFolder folder;
  folder.file("episodes.csv", data, size);
  const std::vector<std::string> before = indexed_bags(folder.path());
  IndexRow row;
  row.bag = "pursuit_2026-01-31-23-59-59_ep0001.bag";
  row.task = "pursuit";
  append_to_index(folder.path(), row);
  const std::vector<std::string> after = indexed_bags(folder.path());
  threelink_fuzz::require(
      after.size() >= before.size() && std::equal(before.begin(), before.end(), after.begin()),
      "a row was lost");
  if (size > 0 && data[size - 1] == '\n')
    threelink_fuzz::require(after.size() == before.size() + 1 && after.back() == row.bag,
                            "the new row is not found");
  return 0;
}
