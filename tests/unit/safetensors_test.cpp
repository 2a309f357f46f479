// The container of policies and checkpoints, and whole files.
#include "threelink_agent/safetensors.hpp"

#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include "threelink_sim/random.hpp"
#include "threelink_sim/sha256.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_agent;
using nlohmann::json;

Container parse(const std::string& bytes) {
  std::string hash;
  return parse_container(bytes, hash);
}

Container example() {
  Container container;
  container.metadata = {{"text", "quotes \" and \\, \"sha256\":\"\", \xc3\xa9\n"}, {"empty", ""}};
  const float f32[6] = {1, -2, 0.1F, 3e38F, -0.0F, 5};
  const double f64[2] = {1.0 / 3, std::numeric_limits<double>::infinity()};
  const std::int64_t i64[1] = {std::numeric_limits<std::int64_t>::min()};
  const std::uint8_t u8[3] = {0, 128, 255};
  container.tensors["a"] = Tensor::of({3}, u8);
  container.tensors["b"] = Tensor::of({2, 3}, f32);
  container.tensors["c"] = Tensor::of({2}, f64);
  container.tensors["d"] = Tensor::of({}, i64);  // a single number
  container.tensors["e"] = Tensor::of({0, 5}, f32);
  return container;
}

// The bytes of a file whose header is this text but for the digits of its hash.
std::string file_of_text(std::string text, const std::string& data) {
  const std::string hash = threelink_sim::sha256(text);
  text.replace(text.find(std::string(64, '0')), 64, hash);
  const std::uint64_t length = text.size();
  return std::string(reinterpret_cast<const char*>(&length), 8) + text + data;
}

std::string header_text(json header, const std::string& data) {
  header["__metadata__"]["sha256"] = threelink_sim::sha256(data);
  header["__metadata__"]["header_sha256"] = std::string(64, '0');
  return header.dump();
}

// The bytes of a file with any header and right hashes.
std::string file_of(const json& header, const std::string& data) {
  return file_of_text(header_text(header, data), data);
}

json entry(const json& dtype, const json& shape, const json& begin, const json& end) {
  return {{"dtype", dtype}, {"shape", shape}, {"data_offsets", {begin, end}}};
}

void expect_refused(const std::string& bytes, const std::string& part) {
  try {
    parse(bytes);
    FAIL() << "accepted; expected: " << part;
  } catch (const ContainerError& error) {
    EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
}

TEST(Sha256, AgreesWithFips180) {
  EXPECT_EQ(threelink_sim::sha256("abc"),
            "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Safetensors, ComesBackAsItWas) {
  const Container container = example();
  const SerializedContainer file = serialize(container);
  std::string hash;
  const Container back = parse_container(file.bytes, hash);
  EXPECT_EQ(hash, file.sha256);
  EXPECT_EQ(back.metadata, container.metadata);
  ASSERT_EQ(back.tensors.size(), container.tensors.size());
  for (const auto& [name, tensor] : container.tensors) {
    EXPECT_EQ(back.tensors.at(name).dtype, tensor.dtype);
    EXPECT_EQ(back.tensors.at(name).shape, tensor.shape);
    EXPECT_EQ(back.tensors.at(name).bytes, tensor.bytes);
  }
  EXPECT_EQ(back.tensors.at("c").values<double>()[0], 1.0 / 3);
  EXPECT_EQ(back.tensors.at("a").values<std::uint8_t>()[2], 255);
  EXPECT_THROW(back.tensors.at("a").values<float>(), ContainerError);
  EXPECT_EQ(serialize(back).bytes, file.bytes);
}

TEST(Safetensors, IsLaidOutAsTheFormatSays) {
  const std::string bytes = serialize(example()).bytes;
  std::uint64_t length;
  std::memcpy(&length, bytes.data(), 8);
  EXPECT_EQ(length % 8, 0u);
  const json header = json::parse(bytes.substr(8, length));
  EXPECT_EQ(header["c"]["data_offsets"][0], 0);  // the 8-byte numbers first
  EXPECT_EQ(header["a"]["data_offsets"][1], bytes.size() - 8 - length);
  EXPECT_EQ(header["b"]["dtype"], "F32");
  EXPECT_EQ(header["b"]["shape"], json({2, 3}));
}

TEST(Safetensors, RefusesEveryFlippedBitAndEveryTruncation) {
  const std::string bytes = serialize(example()).bytes;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::string flipped = bytes;
    flipped[bit / 8] ^= static_cast<char>(1 << bit % 8);
    ASSERT_THROW(parse(flipped), ContainerError) << "bit " << bit;
  }
  for (std::size_t size = 0; size < bytes.size(); ++size)
    ASSERT_THROW(parse(bytes.substr(0, size)), ContainerError) << size << " bytes";
  EXPECT_THROW(parse(bytes + '\0'), ContainerError);
}

TEST(Safetensors, RefusesHeadersThatLie) {
  const std::string data(8, 'x');
  EXPECT_NO_THROW(parse(file_of({{"t", entry("F32", {2}, 0, 8)}}, data)));
  expect_refused(file_of({{"t", entry("F32", {3}, 0, 12)}}, data), "8 bytes");
  expect_refused(file_of({{"t", entry("F32", {1}, 0, 8)}}, data), "expected 4 bytes");
  expect_refused(file_of({{"t", entry("F32", {2}, 8, 0)}}, data), "expected 8 bytes");
  expect_refused(file_of({{"t", entry("F32", {2}, 8, 16)}}, data), "[0, 8]");
  expect_refused(file_of({{"t", entry("F32", {2}, -8, 0)}}, data), "whole number");
  expect_refused(file_of({{"t", entry("F32", {2.0}, 0, 8)}}, data), "whole number");
  expect_refused(file_of({{"t", entry("F32", {std::uint64_t{1} << 62, 4}, 0, 8)}}, data),
                 "whole number");
  expect_refused(
      file_of({{"t", entry("F32", json::array({1 << 26, 1 << 26, 1 << 26}), 0, 8)}}, data),
      "larger");
  expect_refused(file_of({{"t", entry("F16", {4}, 0, 8)}}, data), "F16");
  expect_refused(file_of({{"t", entry(7, {4}, 0, 8)}}, data), "7");
  expect_refused(
      file_of({{"t", entry("U8", json::array({1, 1, 1, 1, 1, 1, 1, 1, 8}), 0, 8)}}, data),
      "at most 8");
  expect_refused(file_of({{"t", {{"dtype", "U8"}, {"shape", {8}}}}}, data), "entry");
  expect_refused(file_of({{"t", 1}}, data), "entry");
  // Overlap, hole, rest.
  expect_refused(file_of({{"s", entry("U8", {6}, 0, 6)}, {"t", entry("U8", {6}, 2, 8)}}, data),
                 "from 6");
  expect_refused(file_of({{"s", entry("U8", {2}, 0, 2)}, {"t", entry("U8", {2}, 6, 8)}}, data),
                 "from 2");
  expect_refused(file_of({{"t", entry("U8", {6}, 0, 6)}}, data), "expected 6");
  expect_refused(file_of({{"__metadata__", {{"key", 1}}}}, ""), "not text");
}

TEST(Safetensors, RefusesHeadersNestedDeeply) {
  const std::string data(8, 'x');
  for (const std::size_t depth : {33, 80'000, 400'000})
    for (const std::string place : {"\"@\"", "[\"@\"]", "{\"a\":\"@\"}"})
      for (const char* key : {"dtype", "shape", "data_offsets"}) {
        json tensor = entry("F32", {2}, 0, 8);
        tensor[key] = json::parse(place);
        std::string text = header_text({{"t", tensor}}, data);
        text.replace(text.find("\"@\""), 3, std::string(depth, '[') + std::string(depth, ']'));
        expect_refused(file_of_text(text, data), "the header is nested more than 32 deep");
      }
}

TEST(Safetensors, SaysLittleOfWhatItRefuses) {
  const std::string data(8, 'x');
  const json list = json::array({std::string(100'000, 'y')});
  for (const char* key : {"dtype", "shape", "data_offsets"}) {
    json tensor = entry("F32", {2}, 0, 8);
    tensor[key] = key == std::string("data_offsets") ? json::array({list, 8}) : list;
    for (const std::string& name : {std::string("t"), std::string(100'000, 'z')}) {
      try {
        parse(file_of({{name, tensor}}, data));
        FAIL() << key;
      } catch (const ContainerError& error) {
        EXPECT_LT(std::string(error.what()).size(), 400u);
        EXPECT_EQ(error.for_peers().find("yy"), std::string::npos);
      }
    }
  }
}

TEST(Safetensors, RefusesHeadersThatReadersTakeDifferently) {
  const std::string data(8, 'x'), good = header_text({{"t", entry("F32", {2}, 0, 8)}}, data);
  EXPECT_NO_THROW(parse(file_of_text(good + "   ", data)));
  expect_refused(file_of_text(good + "{}", data), "the header is not JSON: line 1, column ");
  expect_refused(file_of_text("\xef\xbb\xbf" + good, data), "its header is not a JSON object");
  expect_refused(file_of_text(" " + good, data), "its header is not a JSON object");
  std::string twice = good;
  twice.insert(twice.find("\"dtype\""), "\"dtype\":\"F32\",");
  expect_refused(file_of_text(twice, data), "has the key \"dtype\" twice");
  twice = good;
  twice.insert(1, "\"t\":1,");
  expect_refused(file_of_text(twice, data), "has the key \"t\" twice");
}

TEST(Safetensors, SaysWhatAFileIsInstead) {
  expect_refused("version https://git-lfs.github.com/spec/v1\noid sha256:4d7a\nsize 5\n",
                 "is a Git LFS pointer, not the file itself: run `git lfs pull`");
  expect_refused("<!DOCTYPE html>\n<html>404</html>\n", "is an HTML page");
  expect_refused("{\"actor\": [1, 2, 3]}", "is not a safetensors file");
  expect_refused("PK\x03\x04 and what PyTorch writes", "is a ZIP archive");
}

TEST(Safetensors, RefusesWhatIsNoContainer) {
  expect_refused("", "few");
  expect_refused(std::string(8, '\xff'), "header");
  expect_refused(std::string(100, '\0'), "JSON");
  const std::uint64_t length = 200000;
  const std::string prefix(reinterpret_cast<const char*>(&length), 8);
  expect_refused(prefix + std::string(length, '['), "JSON");
  expect_refused(std::string(kMaxContainerBytes + 1, ' '), "allowed");
  Container container;
  container.metadata["text"] = "\xff";
  EXPECT_THROW(serialize(container), ContainerError);
  container.metadata["text"] = std::string(kMaxHeaderBytes, ' ');
  EXPECT_THROW(serialize(container), ContainerError);
}

}  // namespace
}  // namespace threelink_tests
