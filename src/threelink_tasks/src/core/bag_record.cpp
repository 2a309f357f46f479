#include "bag_record.hpp"

namespace threelink_tasks {

std::optional<BagFields> BagFields::parse(std::string_view bytes) {
  BagFields fields;
  BagCursor cursor(bytes);
  while (!cursor.at_end()) {
    const auto field = cursor.take_sized();
    const std::size_t equals = field ? field->find('=') : std::string_view::npos;
    if (equals == std::string_view::npos || fields.size_ == kMost) return std::nullopt;
    const std::string_view name = field->substr(0, equals);
    if (fields.has(name)) return std::nullopt;
    fields.fields_[fields.size_++] = {name, field->substr(equals + 1)};
  }
  return fields;
}

const BagFields::Field* BagFields::find(std::string_view name) const {
  for (std::size_t i = 0; i < size_; ++i)
    if (fields_[i].first == name) return &fields_[i];
  return nullptr;
}

std::string_view BagFields::text(std::string_view name) const {
  const Field* field = find(name);
  return field ? field->second : std::string_view();
}

bool BagFields::operator==(const BagFields& other) const {
  if (size_ != other.size_) return false;
  for (std::size_t i = 0; i < size_; ++i) {
    const Field* same = other.find(fields_[i].first);
    if (!same || same->second != fields_[i].second) return false;
  }
  return true;
}

std::optional<std::string_view> BagCursor::take(std::size_t size) {
  if (size > bytes_.size() - at_) return std::nullopt;
  const std::string_view taken = bytes_.substr(at_, size);
  at_ += size;
  return taken;
}

std::optional<std::string_view> BagCursor::take_sized() {
  const std::size_t before = at_;
  const auto size = take_integer<std::uint32_t>();
  const auto taken = size ? take(*size) : std::nullopt;
  if (!taken) at_ = before;
  return taken;
}

}  // namespace threelink_tasks
