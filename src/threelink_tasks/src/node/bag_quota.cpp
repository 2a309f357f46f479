#include "bag_quota.hpp"

#include <deque>
#include <set>

#include <fmt/format.h>
#include <ros/console.h>

#include "../core/bag_name.hpp"
#include "episode_index.hpp"

namespace threelink_tasks {
namespace {

namespace fs = std::filesystem;

constexpr double kMegabyte = 1e6;

// 0 if there is no such file.
std::uintmax_t size_of(const fs::path& path) {
  std::error_code absent;
  if (!fs::is_regular_file(fs::symlink_status(path, absent))) return 0;
  const std::uintmax_t size = fs::file_size(path, absent);
  return absent ? 0 : size;
}

struct Bag {
  fs::path path, picture;
  std::uintmax_t bytes;
};

std::deque<Bag> bags_in(const fs::path& folder) {
  std::deque<Bag> bags;
  std::set<std::string> seen;
  for (const std::string& name : indexed_bags(folder)) {
    // A row may say anything; what is not named as the recorder does is not its to delete.
    if (!is_bag_name(name) || !seen.insert(name).second) continue;
    const fs::path path = folder / name, picture = fs::path(path).replace_extension(".png");
    if (fs::is_regular_file(fs::symlink_status(path)))
      bags.push_back({path, picture, size_of(path) + size_of(picture)});
  }
  return bags;
}

}  // namespace

std::uintmax_t BagQuota::delete_oldest(std::uintmax_t open_bytes, std::size_t spared) const {
  std::uintmax_t total = open_bytes;
  if (parameters_.keep == 0 && parameters_.max_total_mb == 0) return total;
  std::deque<Bag> bags = bags_in(folder_);
  for (const Bag& bag : bags) total += bag.bytes;
  const auto too_many = [&] {
    return parameters_.keep > 0 && bags.size() > static_cast<std::size_t>(parameters_.keep);
  };
  const auto too_much = [&] {
    return parameters_.max_total_mb > 0 && total > parameters_.max_total_mb * kMegabyte;
  };
  while (bags.size() > spared && (too_many() || too_much())) {
    const Bag& oldest = bags.front();
    fs::remove(oldest.path);
    if (fs::is_regular_file(fs::symlink_status(oldest.picture))) fs::remove(oldest.picture);
    ROS_INFO("deleted the oldest bag, %s (%ju bytes): ~keep = %d, ~max_total_mb = %g",
             oldest.path.c_str(), oldest.bytes, parameters_.keep, parameters_.max_total_mb);
    total -= oldest.bytes;
    bags.pop_front();
  }
  return total;
}

void BagQuota::make_room_for(const fs::path& open_bag) const {
  const std::uintmax_t total = delete_oldest(size_of(open_bag), 0);
  if (parameters_.max_total_mb > 0 && total > parameters_.max_total_mb * kMegabyte)
    throw BagQuotaError(fmt::format("{} bytes are more than ~max_total_mb = {} allows", total,
                                    parameters_.max_total_mb));
  const std::uintmax_t available = fs::space(open_bag).available;
  if (available < parameters_.min_free_mb * kMegabyte)
    throw BagQuotaError(fmt::format("{} bytes are left on the disk, fewer than ~min_free_mb = {}",
                                    available, parameters_.min_free_mb));
}

}  // namespace threelink_tasks
