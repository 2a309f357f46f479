// How much of the disk the bags of a folder may take.
#pragma once

#include <cstdint>
#include <filesystem>
#include <stdexcept>

namespace threelink_tasks {

struct BagQuotaParameters {
  int keep = 0;              // bags, without the open one; 0: all
  double max_total_mb = 0;   // [10^6 bytes] all bags and their pictures; 0: no limit
  double min_free_mb = 100;  // [10^6 bytes] left to others on the disk
};

// No room for the open bag; what() names path, bytes and bound.
class BagQuotaError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

class BagQuota {
 public:
  BagQuota(const std::filesystem::path& folder, const BagQuotaParameters& parameters)
      : folder_(folder), parameters_(parameters) {}

  // Deletes the oldest bags, with their pictures, until the rest is within `keep` and
  // `max_total_mb`. Bags that episodes.csv does not list are nobody's to delete, and the newest one
  // stays. Throws std::filesystem::filesystem_error if one cannot be deleted.
  void rotate() const { delete_oldest(0, 1); }

  // The same with an open bag, of which nothing is deleted. Throws BagQuotaError if it alone is
  // more than `max_total_mb`, or less than `min_free_mb` is left on its disk.
  void make_room_for(const std::filesystem::path& open_bag) const;

 private:
  // Spares the newest ones. Returns the bytes of all that is left, open_bytes among them.
  std::uintmax_t delete_oldest(std::uintmax_t open_bytes, std::size_t spared) const;

  std::filesystem::path folder_;
  BagQuotaParameters parameters_;
};

}  // namespace threelink_tasks
