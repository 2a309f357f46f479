// Mutations of safetensors containers: afterwards length of the header and both hashes are mostly
// right again, so that what is behind them is reached. Linked to the harnesses of containers.
#include <algorithm>
#include <cstring>
#include <string>

#include "fuzz.hpp"
#include "threelink_sim/sha256.hpp"

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

constexpr std::size_t kLengthBytes = 8, kDigits = 64;

// Where the value of a key begins, if 64 bytes follow.
std::size_t find_digits(const std::string& header, const std::string& key) {
  const std::string before = '"' + key + "\":\"";
  const std::size_t at = header.find(before);
  if (at == std::string::npos || header.size() - at < before.size() + kDigits)
    return std::string::npos;
  return at + before.size();
}

void put_digits(std::string& header, const std::string& key, const std::string& digits) {
  const std::size_t at = find_digits(header, key);
  if (at != std::string::npos) header.replace(at, kDigits, digits);
}

void seal(std::string& bytes) {
  if (bytes.size() < kLengthBytes) return;
  std::uint64_t length;
  std::memcpy(&length, bytes.data(), kLengthBytes);
  // A header that has grown or shrunk still ends where the padding of its JSON does.
  const std::size_t end = bytes.find("}}", kLengthBytes);
  if (end != std::string::npos) {
    length = end + 2 - kLengthBytes;
    while (kLengthBytes + length < bytes.size() && bytes[kLengthBytes + length] == ' ') ++length;
  }
  length = std::min<std::uint64_t>(length, bytes.size() - kLengthBytes);
  std::string header = bytes.substr(kLengthBytes, length);
  const std::string data = bytes.substr(kLengthBytes + length);
  put_digits(header, "sha256", threelink_sim::sha256(data));
  put_digits(header, "header_sha256", std::string(kDigits, '0'));
  put_digits(header, "header_sha256", threelink_sim::sha256(header));
  std::memcpy(bytes.data(), &length, kLengthBytes);
  bytes = bytes.substr(0, kLengthBytes) + header + data;
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size,
                                               std::size_t most, unsigned seed) {
  size = LLVMFuzzerMutate(data, size, most);
  if (seed % 8 == 0) return size;
  std::string bytes = threelink_fuzz::text(data, size);
  seal(bytes);
  std::copy(bytes.begin(), bytes.end(), data);
  return bytes.size();
}
