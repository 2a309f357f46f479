#include "threelink_sim/range.hpp"

#include <cstdint>
#include <type_traits>

#include <fmt/format.h>

namespace threelink_sim {

template <class T>
std::string Range<T>::text() const {
  const auto number = [](T value) {
    if constexpr (std::is_floating_point_v<T>)
      return fmt::format("{:.10g}", value);
    else
      return fmt::format("{}", value);
  };
  return fmt::format("in {}{}, {}{}", low_open ? '(' : '[', number(low), number(high),
                     high_open ? ')' : ']');
}

template struct Range<double>;
template struct Range<int>;
template struct Range<std::int64_t>;
template struct Range<std::uint32_t>;
template struct Range<std::uint64_t>;

}  // namespace threelink_sim
