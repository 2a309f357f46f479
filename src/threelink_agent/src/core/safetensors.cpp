#include "threelink_agent/safetensors.hpp"

#include <algorithm>
#include <cstring>
#include <type_traits>
#include <utility>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/json.hpp"
#include "threelink_sim/sha256.hpp"

#if __BYTE_ORDER__ != __ORDER_LITTLE_ENDIAN__
#error "safetensors files are little-endian; this code copies memory as it is"
#endif

namespace threelink_agent {
namespace {

using nlohmann::json;
using threelink_sim::excerpt;
using threelink_sim::json_excerpt;

constexpr std::size_t kLengthBytes = 8;
constexpr char kMetadata[] = "__metadata__";
constexpr char kDataHash[] = "sha256";
constexpr char kHeaderHash[] = "header_sha256";
constexpr std::size_t kMaxRank = 8;
const std::string kZeroHash(64, '0');

struct DtypeEntry {
  Dtype dtype;
  const char* name;
  std::size_t size;
};
constexpr DtypeEntry kDtypes[] = {{Dtype::kF32, "F32", 4},
                                  {Dtype::kF64, "F64", 8},
                                  {Dtype::kI64, "I64", 8},
                                  {Dtype::kU8, "U8", 1}};

const DtypeEntry& entry(Dtype dtype) {
  return *std::find_if(std::begin(kDtypes), std::end(kDtypes),
                       [&](const DtypeEntry& e) { return e.dtype == dtype; });
}

template <class T>
constexpr Dtype dtype_of() {
  if (std::is_same_v<T, float>) return Dtype::kF32;
  if (std::is_same_v<T, double>) return Dtype::kF64;
  if (std::is_same_v<T, std::int64_t>) return Dtype::kI64;
  return Dtype::kU8;
}

const json& member(const json& object, const char* key, const std::string& name) {
  const auto found = object.find(key);
  if (found == object.end())
    throw ContainerError(fmt::format("{} has no \"{}\"", excerpt(name), key));
  return *found;
}

// A whole number in [0, max].
std::size_t size_of(const json& value, std::size_t max, const std::string& name) {
  if (!value.is_number_unsigned() || value.get<std::uint64_t>() > max)
    throw ContainerError(fmt::format("{} is {}, not a whole number in [0, {}]", excerpt(name),
                                     json_excerpt(value), max));
  return value.get<std::size_t>();
}

// One tensor's entry in the header.
struct Place {
  std::string name;
  Dtype dtype;
  TensorShape shape;
  std::size_t begin, end;
};

Place parse_place(const std::string& name, const json& value, std::size_t data_bytes) {
  if (!value.is_object() || value.size() != 3)
    throw ContainerError(excerpt(name) + ": its entry is not {dtype, shape, data_offsets}");
  Place place{name, {}, {}, 0, 0};
  const json& dtype = member(value, "dtype", name);
  const auto known = std::find_if(std::begin(kDtypes), std::end(kDtypes),
                                  [&](const DtypeEntry& e) { return dtype == e.name; });
  if (known == std::end(kDtypes))
    throw ContainerError(fmt::format("{} has dtype {}, not F32, F64, I64 or U8", excerpt(name),
                                     json_excerpt(dtype)));
  place.dtype = known->dtype;

  const json& shape = member(value, "shape", name);
  if (!shape.is_array() || shape.size() > kMaxRank)
    throw ContainerError(
        fmt::format("{}: shape is not a list of at most {}", excerpt(name), kMaxRank));
  std::size_t bytes = known->size;
  for (const json& size : shape) {
    // Sizes of at most 2^26 and products checked at each step: nothing overflows.
    place.shape.push_back(size_of(size, kMaxContainerBytes, name + ": a size of the shape"));
    bytes *= place.shape.back();
    if (bytes > data_bytes)
      throw ContainerError(fmt::format("{} of shape {} is larger than the data part of {} bytes",
                                       excerpt(name), json_excerpt(shape), data_bytes));
  }
  const json& offsets = member(value, "data_offsets", name);
  if (!offsets.is_array() || offsets.size() != 2)
    throw ContainerError(excerpt(name) + ": data_offsets is not [begin, end]");
  place.begin = size_of(offsets[0], data_bytes, name + ": the begin of its data");
  place.end = size_of(offsets[1], data_bytes, name + ": the end of its data");
  if (place.end < place.begin || place.end - place.begin != bytes)
    throw ContainerError(fmt::format("{} of shape {} has data from {} to {}, expected {} bytes",
                                     excerpt(name), to_string(place.shape), place.begin, place.end,
                                     bytes));
  return place;
}

std::map<std::string, std::string> parse_metadata(const json& value) {
  if (!value.is_object()) throw ContainerError("__metadata__ is not an object");
  std::map<std::string, std::string> metadata;
  for (const auto& item : value.items()) {
    if (!item.value().is_string())
      throw ContainerError(fmt::format("metadata \"{}\" is not text", excerpt(item.key())));
    metadata[item.key()] = item.value().get<std::string>();
  }
  return metadata;
}

// Takes a hash out of the metadata.
std::string take_hash(std::map<std::string, std::string>& metadata, const char* key) {
  const auto found = metadata.find(key);
  if (found == metadata.end()) throw ContainerError(fmt::format("metadata \"{}\" is missing", key));
  std::string hash = found->second;
  if (hash.size() != kZeroHash.size() ||
      hash.find_first_not_of("0123456789abcdef") != std::string::npos)
    throw ContainerError(fmt::format("metadata \"{}\" is not 64 hex digits", key));
  metadata.erase(found);
  return hash;
}

void check_hash(const char* what, const std::string& stated, const std::string& actual) {
  if (stated != actual)
    throw ContainerError(
        fmt::format("damaged: the {} has sha256 {}, but the file states {}", what, actual, stated),
        fmt::format("damaged: the {} has another sha256 than the file states", what));
}

void check_header_hash(std::string header, const std::string& stated) {
  const std::size_t at = header.find(stated);
  if (at == std::string::npos || header.find(stated, at + 1) != std::string::npos)
    throw ContainerError("the digits of header_sha256 are not there exactly once");
  header.replace(at, stated.size(), kZeroHash);
  check_hash("header", stated, threelink_sim::sha256(header));
}

// The JSON header, of a length that stands in front of it.
std::string header_of(const std::string& bytes) {
  std::string reason = fmt::format("{} bytes are too few for one", bytes.size());
  if (bytes.size() >= kLengthBytes) {
    std::uint64_t length;
    std::memcpy(&length, bytes.data(), kLengthBytes);
    const std::size_t rest = bytes.size() - kLengthBytes;
    if (length <= std::min(rest, kMaxHeaderBytes) && length > 0 && bytes[kLengthBytes] == '{')
      return bytes.substr(kLengthBytes, length);
    reason = length > rest || length > kMaxHeaderBytes
                 ? fmt::format(
                       "the header would have {} bytes, but only {} follow and {} are "
                       "allowed",
                       length, rest, kMaxHeaderBytes)
                 : "its header is not a JSON object";
  }
  const std::string mistaken = threelink_sim::mistaken_format(bytes);
  if (!mistaken.empty()) throw ContainerError(mistaken, mistaken);
  const std::string none = "is not a safetensors file";
  throw ContainerError(none + ": " + reason, none);
}

json parse_header(const std::string& text) {
  constexpr std::size_t kMostValues = 20'000;
  try {
    return threelink_sim::parse_json(text, kMostValues);
  } catch (const threelink_sim::FormatError& error) {
    throw ContainerError(fmt::format("the header {}", error.what()));
  }
}

}  // namespace

std::string to_string(const TensorShape& shape) {
  return fmt::format("({})", fmt::join(shape, ", "));
}

std::size_t Tensor::count() const {
  std::size_t product = 1;
  for (std::size_t size : shape) product *= size;
  return product;
}

template <class T>
Tensor Tensor::of(TensorShape shape, const T* values) {
  Tensor tensor{dtype_of<T>(), std::move(shape), {}};
  tensor.bytes.assign(reinterpret_cast<const char*>(values), tensor.count() * sizeof(T));
  return tensor;
}

template <class T>
std::vector<T> Tensor::values() const {
  if (dtype != dtype_of<T>())
    throw ContainerError(
        fmt::format("dtype {}, expected {}", entry(dtype).name, entry(dtype_of<T>()).name));
  std::vector<T> values(count());
  std::memcpy(values.data(), bytes.data(), bytes.size());
  return values;
}

template Tensor Tensor::of(TensorShape, const float*);
template Tensor Tensor::of(TensorShape, const double*);
template Tensor Tensor::of(TensorShape, const std::int64_t*);
template Tensor Tensor::of(TensorShape, const std::uint8_t*);
template std::vector<float> Tensor::values() const;
template std::vector<double> Tensor::values() const;
template std::vector<std::int64_t> Tensor::values() const;
template std::vector<std::uint8_t> Tensor::values() const;

SerializedContainer serialize(const Container& container) {
  std::vector<const std::pair<const std::string, Tensor>*> order;
  for (const auto& item : container.tensors) order.push_back(&item);
  // Falling sizes of elements keep every tensor aligned; the map has sorted the names.
  std::stable_sort(order.begin(), order.end(), [](const auto* a, const auto* b) {
    return entry(a->second.dtype).size > entry(b->second.dtype).size;
  });

  json header = json::object();
  std::string data;
  for (const auto* item : order) {
    const auto& [name, tensor] = *item;
    header[name] = {{"dtype", entry(tensor.dtype).name},
                    {"shape", tensor.shape},
                    {"data_offsets", {data.size(), data.size() + tensor.bytes.size()}}};
    data += tensor.bytes;
  }
  const std::string data_hash = threelink_sim::sha256(data);
  header[kMetadata] = container.metadata;
  header[kMetadata][kDataHash] = data_hash;
  header[kMetadata][kHeaderHash] = kZeroHash;
  std::string text;
  try {
    text = header.dump();
  } catch (const json::exception&) {
    throw ContainerError("metadata that is not UTF-8 text");
  }
  text.resize((text.size() + 7) / 8 * 8, ' ');
  if (text.size() > kMaxHeaderBytes ||
      kLengthBytes + text.size() + data.size() > kMaxContainerBytes)
    throw ContainerError(fmt::format("a header of {} and data of {} bytes: at most {} and {}",
                                     text.size(), data.size(), kMaxHeaderBytes,
                                     kMaxContainerBytes));
  // Quotes inside of text are escaped, so that this finds the key and nothing else.
  const std::size_t key = text.find(fmt::format("\"{}\":\"", kHeaderHash));
  const std::size_t digits = text.find(kZeroHash, key);
  text.replace(digits, kZeroHash.size(), threelink_sim::sha256(text));

  const std::uint64_t length = text.size();
  const std::string prefix(reinterpret_cast<const char*>(&length), kLengthBytes);
  return {prefix + text + data, data_hash};
}

Container parse_container(const std::string& bytes, std::string& data_hash) {
  if (bytes.size() > kMaxContainerBytes)
    throw ContainerError(
        fmt::format("{} bytes, at most {} are allowed", bytes.size(), kMaxContainerBytes));
  const std::string text = header_of(bytes);
  const std::string data = bytes.substr(kLengthBytes + text.size());

  const json header = parse_header(text);
  Container container;
  container.metadata = parse_metadata(member(header, kMetadata, "the header"));
  data_hash = take_hash(container.metadata, kDataHash);
  check_header_hash(text, take_hash(container.metadata, kHeaderHash));

  std::vector<Place> places;
  for (const auto& item : header.items())
    if (item.key() != kMetadata)
      places.push_back(parse_place(item.key(), item.value(), data.size()));
  std::sort(places.begin(), places.end(), [](const Place& a, const Place& b) {
    return std::pair(a.begin, a.end) < std::pair(b.begin, b.end);
  });
  std::size_t end = 0;
  for (Place& place : places) {
    if (place.begin != end)
      throw ContainerError(fmt::format("{} has data from {}, expected from {}", excerpt(place.name),
                                       place.begin, end));
    end = place.end;
    container.tensors[place.name] = {place.dtype, std::move(place.shape),
                                     data.substr(place.begin, place.end - place.begin)};
  }
  if (end != data.size())
    throw ContainerError(fmt::format("data of {} bytes, expected {}", data.size(), end));
  check_hash("data part", data_hash, threelink_sim::sha256(data));
  return container;
}

}  // namespace threelink_agent
