// JSON, YAML and CSV of others: what is taken, and hostile texts that are refused in time.
#include <chrono>
#include <cmath>
#include <string>
#include <tuple>
#include <vector>

#include <gtest/gtest.h>

#include "threelink_sim/csv.hpp"
#include "threelink_sim/excerpt.hpp"
#include "threelink_sim/json.hpp"
#include "threelink_sim/yaml.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;
using nlohmann::json;

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

// What is said of a text that `parse` must refuse; never slowly.
template <class Parse>
std::string refusal(Parse&& parse) {
  const auto start = std::chrono::steady_clock::now();
  std::string text = "accepted";
  try {
    parse();
  } catch (const FormatError& error) {
    text = error.what();
  }
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(10)) << text;
  return text;
}
std::string json_refusal(const std::string& text) {
  return refusal([&] { parse_json(text); });
}
std::string yaml_refusal(const std::string& text) {
  return refusal([&] { parse_yaml(text); });
}
std::string csv_refusal(const std::string& text) {
  return refusal([&] { parse_csv(text, "a.csv", {2, 1000, false}); });
}

constexpr char kLfsPointer[] =
    "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2146\nsize 12345\n";
constexpr char kPage[] = "\n<!DOCTYPE html>\n<html><body>404</body></html>\n";

TEST(Json, TakesWhatIsJson) {
  EXPECT_EQ(parse_json(" {\"a\": [1, -2, 0.5, 1e-320, \"\\u00e9\", null, true]} \n"),
            json::parse("{\"a\": [1, -2, 0.5, 1e-320, \"\\u00e9\", null, true]}"));
  EXPECT_NO_THROW(parse_json(repeated("[", kMaxJsonDepth) + repeated("]", kMaxJsonDepth)));
  EXPECT_NO_THROW(parse_json("[{\"a\": 1}, {\"a\": {\"a\": 1}}]"));
}

TEST(Json, SaysWhatIsNone) {
  const std::vector<std::tuple<std::string, std::string>> cases = {
      {"", "is not JSON: line 1, column 1, where the text ends"},
      {"{\"a\": 1,\n  x}", "is not JSON: line 2, column 3"},
      {"[1, 2", "is not JSON: line 1, column 6, where the text ends"},
      {"{} {}", "is not JSON: line 1, column 4"},
      {"{}\n\n]", "is not JSON: line 3, column 1"},
      {"\xef\xbb\xbf{}", "is not JSON: begins with a byte order mark"},
      {"{\"a\": 1, \"b\": 2, \"a\": 3}", "an object has the key \"a\" twice"},
      {"{\"b\": {\"a\": 1, \"\\u0061\": 3}}", "an object has the key \"a\" twice"},
      {"[1e999]", "line 1, column 6: the number 1e999 is too large"},
      {"\"\xff\"", "is not JSON: line 1, column 2"},
      {"nan", "is not JSON"},
      {kLfsPointer, "is a Git LFS pointer, not the file itself: run `git lfs pull`"},
      {kPage, "is an HTML page"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_NE(json_refusal(text).find(message), std::string::npos)
        << text << ": " << json_refusal(text);
}

TEST(Json, EndsHostileTextsInTime) {
  for (std::size_t depth : {kMaxJsonDepth + 1, std::size_t{1'000'000}}) {
    EXPECT_EQ(json_refusal(repeated("[", depth) + repeated("]", depth)),
              "is nested more than 32 deep");
    EXPECT_EQ(json_refusal(repeated("{\"a\":", depth)), "is nested more than 32 deep");
  }
  EXPECT_EQ(json_refusal("[" + repeated("0,", 200'000) + "0]"), "has more than 100000 values");
  EXPECT_EQ(json_refusal("[" + repeated("{},", 200'000) + "0]"), "has more than 100000 values");
}

TEST(Json, KeepsWhatItReadsFromPeers) {
  for (const std::string text : {"{\"secret\": 1, \"secret\": 2}", "secret", "[secret]"}) {
    try {
      parse_json(text);
      FAIL() << text;
    } catch (const FormatError& error) {
      EXPECT_EQ(error.for_peers().find("secret"), std::string::npos) << error.for_peers();
    }
  }
}

TEST(Json, ExcerptsAreShort) {
  EXPECT_EQ(json_excerpt(json::parse("{\"a\": [1, \"x\", null]}")), "{\"a\":[1,\"x\",null]}");
  json deep = 1;
  for (int i = 0; i < 100'000; ++i) deep = json::array({std::move(deep)});
  EXPECT_EQ(json_excerpt(deep), "[[[[[...]]]]]");
  EXPECT_LE(json_excerpt(json(std::string(1000, 'x'))).size(), 90u);
  EXPECT_LE(json_excerpt(json(std::vector<int>(1000, 7))).size(), 90u);
  EXPECT_EQ(json_excerpt(json("a\nb\x1b[2J\xff")), "\"a\\nb\\x1b[2J\\xff\"");
  while (deep.is_array()) {  // so that its destructor need not recurse
    json inner = std::move(deep[0]);
    deep = std::move(inner);
  }
}

TEST(Excerpt, IsOneHarmlessLine) {
  EXPECT_EQ(excerpt("plain \xc3\xa9 text"), "plain \xc3\xa9 text");
  EXPECT_EQ(excerpt("\xc2\x9b"
                    "31m\x7f\r\t"),
            "\\xc2\\x9b31m\\x7f\\r\\t");
  EXPECT_EQ(excerpt("\xed\xa0\x80\xc0\xaf\xf5"), "\\xed\\xa0\\x80\\xc0\\xaf\\xf5");
  EXPECT_EQ(excerpt("abcdef", 3), "abc...");
  EXPECT_EQ(excerpt("abc", 3), "abc");
}

TEST(Yaml, TakesWhatOurFilesUse) {
  const YAML::Node node =
      parse_yaml("# comment\na: 1\nb: [x, 'y', {c: ~}]\nd:\n  - e: |\n      f\n");
  EXPECT_EQ(node["b"][1].as<std::string>(), "y");
  EXPECT_EQ(node["b"][1].Tag(), "!");
  EXPECT_EQ(node["d"][0]["e"].as<std::string>(), "f\n");
  EXPECT_TRUE(parse_yaml("").IsNull());
  EXPECT_TRUE(parse_yaml("# nothing\n").IsNull());
  EXPECT_EQ(parse_yaml("\xef\xbb\xbf"
                       "a: 1\r\nb: 2\r\n")["a"]
                .as<int>(),
            1);
  EXPECT_EQ(parse_yaml("---\na: 1\n...\n")["a"].as<int>(), 1);
  EXPECT_NO_THROW(parse_yaml(repeated("[", kMaxYamlDepth) + repeated("]", kMaxYamlDepth)));
  EXPECT_NO_THROW(parse_yaml("{a: {a: 1}, b: [{a: 1}, {a: 1}]}"));
}

TEST(Yaml, SaysWhatItDoesNotTake) {
  const std::vector<std::tuple<std::string, std::string>> cases = {
      {"a: 1\nb: [", "is not YAML: line "},
      {"a: 1\n a: 2", "is not YAML: line 2"},
      {"seed: &a {b: *a}", "line 1, column 7: anchors (&name) are not taken"},
      {"a: *b", "is not YAML: line 1"},
      {"&a b: 1", "anchors"},
      {"a: !!int ' 5'", "line 1, column 4: tags (!name) are not taken"},
      {"a: !local 5", "tags"},
      {"a: !!map {}", "tags"},
      {"a: !<tag:yaml.org,2002:str> 5", "tags"},
      {"a: 1\nb: 2\na: 3\n", "line 3, column 1: a: given twice"},
      {"c: {\"a\": 1, a: 3}", "line 1, column 13: a: given twice"},
      {"[1, 2]: 3", "a key must be a word"},
      {"? {a: 1}\n: 3", "a key must be a word"},
      {"a: 1\n---\nb: 2\n", "line 2, column 1: a second document begins"},
      {"a: 1\n---\n", "a second document"},
      {"{a: 1} b", "a second document"},
      {std::string("a: 1\nb: \0", 9), "line 2: is not printable text in UTF-8"},
      {"a: \x1b[2J", "line 1: is not printable"},
      {"a: \xc3(", "line 1: is not printable"},
      {std::string("\xff\xfe"
                   "a\0:\0",
                   6),
       "is UTF-16 text, must be UTF-8"},
      {kLfsPointer, "is a Git LFS pointer"},
      {kPage, "is an HTML page"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_NE(yaml_refusal(text).find(message), std::string::npos)
        << text << ": " << yaml_refusal(text);
}

TEST(Yaml, EndsHostileTextsInTime) {
  constexpr std::size_t kMany = 200'000;
  for (const std::string level : {"[", "{a: ", "- ", "? ", "[{a: ", "[a: "})
    EXPECT_NE(yaml_refusal(repeated(level, kMany / level.size())), "accepted") << level;
  std::string ladder, bomb = "a0: &a0 [x]\n";
  for (int i = 0; i < 700; ++i) ladder += std::string(i, ' ') + "a:\n";
  EXPECT_NE(yaml_refusal(ladder).find("nested more than 32 deep"), std::string::npos);
  EXPECT_EQ(yaml_refusal(std::string(250, 'k') + ": 1"), "accepted");
  EXPECT_EQ(yaml_refusal(std::string(251, 'k') + ": 1"),
            "line 1, column 1: a key of 251 bytes, at most 250 are allowed");
  for (int i = 1; i < 30; ++i)
    bomb += "a" + std::to_string(i) + ": &a" + std::to_string(i) + " [" +
            repeated("*a" + std::to_string(i - 1) + ",", 9) + "x]\n";
  EXPECT_NE(yaml_refusal(bomb).find("anchors"), std::string::npos);
  EXPECT_NE(yaml_refusal("[" + repeated("x,", 60'000) + "x]").find("more than 50000 values"),
            std::string::npos);
  EXPECT_NE(yaml_refusal(std::string((1 << 20) + 1, 'x')).find("at most 1048576"),
            std::string::npos);
  // What only keeps the library's scanner busy.
  for (const std::string piece : {"%TAG ! !\n", "&a ", "!a ", "''", "\"", "? a\n", "\n\n \n", "a:",
                                  "a: b: ", "}", "a\n", "#\n", "|\n", ">-\n  x\n", "*", "- |\n"})
    refusal([&] { parse_yaml(repeated(piece, kMany / piece.size())); });
}

TEST(Yaml, KeepsWhatItReadsFromPeers) {
  for (const std::string text :
       {"{secret: 1, secret: 2}", "*secret", "\"\\secret\"", "!secret", "%secret", "a: 'secret"}) {
    try {
      parse_yaml(text);
    } catch (const FormatError& error) {
      EXPECT_EQ(error.for_peers().find("secret"), std::string::npos) << error.for_peers();
    }
  }
}

TEST(Csv, TakesNumbersAsSpreadsheetsWriteThem) {
  const auto rows = parse_csv(
      "\xef\xbb\xbf"
      "0.9,-1e-3\r\n 1 ,\t+2.\r\n1e-320,4e-400\n\r\n\n",
      "a.csv", {2, 10, false});
  ASSERT_EQ(rows.size(), 3u);
  EXPECT_EQ(rows[0].values, (std::vector<double>{0.9, -1e-3}));
  EXPECT_EQ(rows[1].values, (std::vector<double>{1, 2}));
  EXPECT_EQ(rows[2].values, (std::vector<double>{1e-320, 0}));
  EXPECT_EQ(rows[2].line, 3u);
  EXPECT_TRUE(parse_csv("", "a.csv", {2, 10, false}).empty());
  EXPECT_TRUE(parse_csv("\r\n \n", "a.csv", {2, 10, false}).empty());
  const auto gaps = parse_csv("1\n\n2\n", "a.csv", {1, 10, true});
  ASSERT_EQ(gaps.size(), 2u);
  EXPECT_EQ(gaps[1].line, 3u);
}

TEST(Csv, SaysWhereSomethingIsWrong) {
  const std::vector<std::tuple<std::string, std::string>> cases = {
      {"1,2\nx,2\n", "a.csv:2: column 1: \"x\" is no number"},
      {"1,2\n3,\n", "a.csv:2: column 2: \"\" is no number"},
      {"1,2\n\n3,4\n", "a.csv:2: is blank"},
      {"1,nan\n", "a.csv:1: column 2: \"nan\" is no number"},
      {"1,inf\n", "is no number"},
      {"1,0x10\n", "is no number"},
      {"1,1 2\n", "\"1 2\" is no number"},
      {"1,1e999\n", "a.csv:1: column 2: \"1e999\" is too large"},
      {"1\n", "a.csv:1: \"1\" has 1 numbers, must have 2"},
      {"1,2,3\n", "a.csv:1: \"1,2,3\" has more than 2 numbers"},
      {"1;2\n", "\"1;2\" is no number"},
      {"1,\x1b[2J\n", "\"\\x1b[2J\" is no number"},
      {repeated("1,2\n", 1001), "a.csv:1001: more than 1000 rows"},
      {kLfsPointer, "a.csv: is a Git LFS pointer"},
      {kPage, "a.csv: is an HTML page"},
      {std::string("\xff\xfe"
                   "1\0,\0",
                   6),
       "a.csv: is UTF-16"},
  };
  for (const auto& [text, message] : cases)
    EXPECT_NE(csv_refusal(text).find(message), std::string::npos)
        << text << ": " << csv_refusal(text);
}

TEST(Csv, EndsHostileTextsInTime) {
  EXPECT_NE(csv_refusal(std::string(10'000'000, ',')), "accepted");
  EXPECT_LT(csv_refusal(std::string(10'000'000, '1')).size(), 200u);
  EXPECT_EQ(csv_refusal(std::string(10'000'000, '\n')), "accepted");
  refusal([] { parse_csv(std::string(10'000'000, '\n') + "1", "a.csv", {1, 10, true}); });
}

TEST(Csv, KeepsWhatItReadsFromPeers) {
  for (const std::string text : {"secret,1\n", "1,2\nsecret\n", "1,2,secret\n"}) {
    try {
      parse_csv(text, "a.csv", {2, 10, false});
      FAIL() << text;
    } catch (const FormatError& error) {
      EXPECT_EQ(error.for_peers().find("secret"), std::string::npos) << error.for_peers();
      EXPECT_NE(error.for_peers().find("a.csv:"), std::string::npos);
    }
  }
}

}  // namespace
}  // namespace threelink_tests
