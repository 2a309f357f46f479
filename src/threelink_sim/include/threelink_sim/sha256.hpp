/// @file
/// SHA-256 (FIPS 180-4), by OpenSSL.
#pragma once

#include <string>
#include <string_view>

namespace threelink_sim {

/// The hash as 64 lower-case hex digits.
std::string sha256(std::string_view bytes);

}  // namespace threelink_sim
