#include "threelink_sim/node/parameters.hpp"

#include <limits>
#include <vector>

#include <gtest/gtest.h>

namespace threelink_sim {
namespace {

using XmlRpc::XmlRpcValue;

Parameters with(const std::string& name, const XmlRpcValue& value) {
  XmlRpcValue values;
  values[name] = value;
  return Parameters("/node", values);
}

// What the error says; empty if there was none.
template <class Call>
std::string error_of(Call call) {
  try {
    call();
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "";
}

TEST(Parameters, TakesWhatIsGivenAndElseTheDefault) {
  XmlRpcValue values;
  values["real"] = 0.25;
  values["whole"] = 3;
  values["flag"] = true;
  values["text"] = std::string("abc");
  Parameters parameters("/node", values);
  EXPECT_EQ(parameters.real("real", {0, 1}), 0.25);
  EXPECT_EQ(parameters.real("whole", {0, 3}), 3.0) << "a whole number is a real one";
  EXPECT_EQ(parameters.integer("whole", {3, 3}), 3);
  EXPECT_TRUE(parameters.flag("flag"));
  EXPECT_EQ(parameters.text("text"), "abc");
  EXPECT_EQ(parameters.choice("text", {"abc", "def"}), "abc");
  EXPECT_EQ(parameters.real("absent", {0, 1}, 0.5), 0.5);
  EXPECT_EQ(parameters.integer("absent", {0, 1}, 1), 1);
  EXPECT_FALSE(parameters.flag("absent", false));
  EXPECT_EQ(parameters.text("absent", ""), "");
  EXPECT_NO_THROW(parameters.finish());
  EXPECT_NO_THROW(Parameters("/node", XmlRpcValue()).finish());
}

TEST(Parameters, RequiredOnesAreRequired) {
  Parameters parameters("/node", XmlRpcValue());
  EXPECT_EQ(error_of([&] { parameters.real("dt", {0, 1}); }), "/node/dt is missing");
  EXPECT_EQ(error_of([&] { parameters.text("file"); }), "/node/file is missing");
}

TEST(Parameters, ErrorsNameParameterValueTypeAndBound) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  const auto real = [](const XmlRpcValue& value) {
    return error_of([&] { with("x", value).real("x", {0, 1}, 0.5); });
  };
  EXPECT_EQ(real(1.5), "/node/x = 1.5 (double): must be in [0, 1]");
  EXPECT_EQ(real(-1), "/node/x = -1 (int): must be in [0, 1]");
  EXPECT_EQ(real(nan), "/node/x = nan (double): must be finite");
  EXPECT_EQ(real(infinity), "/node/x = inf (double): must be finite");
  EXPECT_EQ(real(true), "/node/x = true (bool): must be a number");
  EXPECT_EQ(real(std::string("fast")), "/node/x = \"fast\" (string): must be a number");
  XmlRpcValue list, dictionary;
  list[0] = 1.0;
  dictionary["y"] = 1.0;
  EXPECT_EQ(real(list), "/node/x = a list: must be a number");
  EXPECT_EQ(real(dictionary), "/node/x = a dictionary: must be a number");

  const auto integer = [](const XmlRpcValue& value) {
    return error_of([&] { with("x", value).integer("x", {2, 32}, 3); });
  };
  EXPECT_EQ(integer(33), "/node/x = 33 (int): must be in [2, 32]");
  EXPECT_EQ(integer(3.0), "/node/x = 3 (double): must be a whole number");
  EXPECT_EQ(error_of([&] { with("x", 1).flag("x"); }), "/node/x = 1 (int): must be true or false");
  EXPECT_EQ(error_of([&] { with("x", 1).text("x"); }), "/node/x = 1 (int): must be text");
  EXPECT_EQ(error_of([&] {
              with("x", std::string("up")).choice("x", {"left", "right"});
            }),
            "/node/x = \"up\" (string): must be one of: left, right");
}

TEST(Parameters, NumbersThatYamlTookForTextComeWithAdvice) {
  const auto advice = [](const char* text) {
    const std::string error = error_of([&] { with("x", std::string(text)).real("x", {0, 1}); });
    const std::string start = std::string("/node/x = \"") + text + "\" (string): must be a number";
    EXPECT_EQ(error.substr(0, start.size()), start);
    return error.substr(start.size());
  };
  EXPECT_EQ(advice("1e-3"), "; write 1.0e-3, which YAML takes for a number");
  EXPECT_EQ(advice("-2E-05"), "; write -2.0E-05, which YAML takes for a number");
  EXPECT_EQ(advice("1.5e3"), "; write 1.5e+3, which YAML takes for a number");
  EXPECT_EQ(advice("0.5"), "; write it without quotes");
  EXPECT_EQ(advice("nan"), "");
  EXPECT_EQ(advice(""), "");
  EXPECT_EQ(advice("1e-3x"), "");
}

TEST(Parameters, UnknownOnesAreRefusedWithTheNearestName) {
  Parameters parameters = with("lenght_scale", 2.0);
  parameters.real("time_scale", {0, 10}, 1);
  parameters.real("length_scale", {0, 10}, 1);
  EXPECT_EQ(error_of([&] { parameters.finish(); }),
            "/node/lenght_scale: no such parameter; the nearest one is /node/length_scale");
}

TEST(Parameters, AValueInPlaceOfTheDictionaryIsRefused) {
  EXPECT_EQ(error_of([] { Parameters("/node", XmlRpcValue(3)); }),
            "/node = 3 (int): must be a dictionary of parameters");
}

TEST(Parameters, RefuseNamesTheValue) {
  EXPECT_EQ(error_of([] { with("file", std::string("a.b")).refuse("file", "cannot be read"); }),
            "/node/file = \"a.b\" (string): cannot be read");
}

TEST(ParameterMap, ReadsYamlAndRecordsWhatItRead) {
  const char* yaml = "{a: 1, b: 1.0e-05, c: true, d: \"x: \\\"y\\\"\", e: [[1, 2.5], [0.1, -3]]}";
  std::string effective;
  for (const std::string& text : {std::string(yaml), std::string()}) {
    ParameterMap map("f", YAML::Load(text.empty() ? effective : text));
    EXPECT_EQ(map.real("a", {0, 1}), 1);
    EXPECT_EQ(map.real("b", {0, 1}), 1e-5);
    EXPECT_TRUE(map.flag("c"));
    EXPECT_EQ(map.text("d"), "x: \"y\"");
    const auto points = map.points("e", {-5, 5}, nullptr);
    EXPECT_EQ(points, (ParameterMap::Points{{1, 2.5}, {0.1, -3}}));
    EXPECT_EQ(map.real("third", {0, 1}, 1.0 / 3), 1.0 / 3);
    EXPECT_EQ(map.integer("whole", {0, 10}, 7), 7);
    EXPECT_NO_THROW(map.finish());
    effective = map.effective();
  }
  EXPECT_EQ(effective,
            "a: 1.0\nb: 1.0e-05\nc: true\nd: \"x: \\\"y\\\"\"\n"
            "e: [[1.0, 2.5], [0.1, -3.0]]\nthird: 0.3333333333333333\nwhole: 7\n");
}

TEST(ParameterMap, TakesQuotedNumbersForText) {
  ParameterMap map("f", YAML::Load("{a: \"1\", b: 1, c: 1.0}"));
  EXPECT_EQ(error_of([&] {
              map.real("a", {0, 1});
            }),
            "f/a = \"1\" (string): must be a number; write it without quotes");
  EXPECT_EQ(map.text("a"), "1");
  EXPECT_EQ(error_of([&] { map.text("b"); }), "f/b = 1 (int): must be text");
  EXPECT_EQ(error_of([&] {
              map.integer("c", {0, 1});
            }),
            "f/c = 1 (double): must be a whole number");
}

TEST(ParameterMap, ReadsNumbersOnlyAsTheyAreWritten) {
  // A tag, or another writer, can leave blanks that the C library skips.
  for (const char* word : {" 5", "5 ", "\n5", "\t5", "+", "0x10", "5,0", "1_000", "5.0 "}) {
    YAML::Node values;
    values["a"] = word;
    values["a"].SetTag("tag:yaml.org,2002:int");
    ParameterMap map("f", values);
    EXPECT_NE(error_of([&] { map.real("a", {-10, 10}); }), "") << word;
    EXPECT_NE(error_of([&] { map.integer("a", {-10, 10}); }), "") << word;
  }
}

TEST(ParameterMap, OfATextThatIsHostile) {
  const auto refusal = [](const std::string& yaml) {
    return error_of([&] { parse_parameters("parameters", yaml).finish(); });
  };
  EXPECT_EQ(refusal("{}"), "");
  EXPECT_EQ(refusal(""), "");
  EXPECT_EQ(refusal("abc"), "parameters = \"abc\" (string): must be a dictionary of parameters");
  EXPECT_EQ(refusal("{a: &b [*b]}").rfind("parameters: line 1, column 5: anchors", 0), 0u);
  EXPECT_EQ(refusal("{a: !!int ' 5'}").rfind("parameters: line 1, column 5: tags", 0), 0u);
  EXPECT_EQ(refusal("{a: 1, a: 2}"), "parameters: line 1, column 8: a: given twice");
  EXPECT_EQ(refusal("{a: [").rfind("parameters: is not YAML: line 1", 0), 0u);
  EXPECT_LT(refusal(std::string(100'000, 'x') + ": 1").size(), 200u);
}

TEST(Parameters, NestedTooDeeplyAreRefused) {
  XmlRpcValue deep(1);
  for (int i = 0; i < 40; ++i) {
    XmlRpcValue list;
    list[0] = deep;
    deep = list;
  }
  EXPECT_EQ(error_of([&] { with("a", deep); }), "/node: nested more than 32 deep");
}

TEST(ParameterMap, ErrorsOfAFileAreNotQuotedToPeers) {
  XmlRpcValue values;
  values["points"] = std::string("FILE");
  Parameters map("/node", values);
  try {
    map.points("points", {0, 1}, [](const std::string&) -> ParameterMap::Points {
      throw UsageError("FILE:1: secret", "FILE:1: is no number");
    });
    FAIL();
  } catch (const UsageError& error) {
    EXPECT_EQ(std::string(error.what()), "/node/points = \"FILE\" (string): FILE:1: secret");
    EXPECT_EQ(text_for_peers(error), "/node/points = \"FILE\" (string): FILE:1: is no number");
  }
}

TEST(ParameterMap, RefusesWhatIsGivenTwiceButIgnoresWhatItIsTold) {
  ParameterMap map("f", YAML::Load("{a: 1, a: 2}"));
  map.real("a", {0, 9});
  EXPECT_EQ(error_of([&] { map.finish(); }), "f/a: given twice");
  ParameterMap other("f", YAML::Load("{a: 1, b: 2}"));
  other.real("a", {0, 9});
  EXPECT_NE(error_of([&] { other.finish(); }), "");
  other.ignore("b");
  EXPECT_NO_THROW(other.finish());
}

}  // namespace
}  // namespace threelink_sim
