// What follows from the list of a struct's fields: reading, checking, writing, comparison, help.
#include "threelink_sim/fields.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "threelink_sim/environment.hpp"

namespace threelink_fields_test {

using namespace threelink_sim;

enum class Shape { kRound, kSquare };
Words<Shape> words_of(Shape) { return {{Shape::kRound, "round"}, {Shape::kSquare, "square"}}; }

struct Inner {
  double share = 0.5;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("share", self.share, Range<double>{0, 1, true, true}, "of the whole");
  }
};

struct Outer {
  std::uint64_t seed = 1;
  std::vector<int> widths = {4, 8};
  Shape shape = Shape::kRound;
  bool flag = false;
  Inner inner;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("seed", self.seed, Range<std::uint64_t>{0, 1000}, "of every number");
    visit("widths", self.widths, Range<int>{1, 9}, "of the layers");
    visit("shape", self.shape, "of the pool");
    visit("flag", self.flag, "whether");
    visit_section("inner", self.inner, visit);
  }
};

const std::string kYaml =
    "seed: 7\nwidths: [1, 9]\nshape: square\nflag: true\ninner:\n  share: 0.25\n";

Outer read(const std::string& yaml) {
  ParameterMap map = parse_config("file", yaml, {});
  Outer outer;
  Outer::fields(outer, FieldReader(map));
  map.finish();
  return outer;
}

std::string refusal(const std::string& found, const std::string& put) {
  std::string yaml = kYaml;
  try {
    read(yaml.replace(yaml.find(found), found.size(), put));
  } catch (const ParameterError& error) {
    return error.what();
  }
  return "taken";
}

TEST(Fields, WhatIsWrittenIsRead) {
  const Outer outer = read(kYaml);
  EXPECT_EQ(outer.seed, 7u);
  EXPECT_EQ(outer.widths, (std::vector<int>{1, 9}));
  EXPECT_EQ(outer.shape, Shape::kSquare);
  EXPECT_TRUE(outer.flag);
  EXPECT_EQ(outer.inner.share, 0.25);
  EXPECT_EQ(to_yaml(field_texts(outer)), kYaml);
}

TEST(Fields, RefusalsNameFileFieldValueAndBound) {
  EXPECT_EQ(refusal("seed: 7", "seed: 1001"), "file: seed = 1001: must be in [0, 1000]");
  EXPECT_EQ(refusal("seed: 7", "seed: -1"), "file: seed = -1: must be in [0, 1000]");
  EXPECT_EQ(refusal("share: 0.25", "share: 1.0"), "file: inner.share = 1.0: must be in (0, 1)");
  EXPECT_EQ(refusal("share: 0.25", "share: 0.0"), "file: inner.share = 0.0: must be in (0, 1)");
  EXPECT_EQ(refusal("[1, 9]", "[1, 10]"), "file: widths[1] = 10: must be in [1, 9]");
  EXPECT_EQ(refusal("square", "oval"), "file: shape = oval: must be one of: round, square");
  EXPECT_EQ(refusal("flag: true\n", ""), "file: flag: missing");
  EXPECT_EQ(refusal("share", "shares"),
            "file: inner.shares: unknown key (the nearest known one is inner.share)");
  EXPECT_EQ(refusal("seed: 7", "seed: 7\ninner.share: 0.5"), "file: inner.share: given twice");
}

TEST(Fields, ParametersKeepTheDefaultsOfTheStruct) {
  ParameterMap map("/node", YAML::Load("{share: 0.75}"));
  Inner inner;
  Inner::fields(inner, FieldReader(map));
  map.finish();
  EXPECT_EQ(inner.share, 0.75);
  ParameterMap none("/node", YAML::Node());
  Inner defaults;
  Inner::fields(defaults, FieldReader(none));
  EXPECT_EQ(defaults.share, 0.5);
  EXPECT_EQ(none.effective(), "share: 0.5\n");
}

TEST(Fields, AreCheckedAlsoWhereNoFileWasRead) {
  Outer outer;
  EXPECT_NO_THROW(check_fields(outer));
  for (const double share : {0.0, 1.0, std::nan(""), std::numeric_limits<double>::infinity()}) {
    outer.inner.share = share;
    EXPECT_THROW(check_fields(outer), std::invalid_argument) << share;
  }
  EnvironmentConfig environment;
  environment.model.gamma = 11;
  try {
    environment.validate();
    FAIL();
  } catch (const std::invalid_argument& error) {
    EXPECT_STREQ(error.what(), "gamma = 11: must be in [0.001, 10]");
  }
}

TEST(Fields, TheFirstDifferenceIsNamed) {
  Outer a, b;
  const auto difference = [&] { return first_difference(field_texts(a), field_texts(b)); };
  EXPECT_FALSE(difference());
  b.inner.share = std::nextafter(0.5, 1);
  ASSERT_TRUE(difference());
  EXPECT_EQ(difference()->name, "inner.share");
  EXPECT_EQ(difference()->a, "0.5");
  EXPECT_EQ(difference()->b, "0.5000000000000001");
}

TEST(Fields, HelpNamesDefaultMeaningAndBound) {
  EXPECT_EQ(field_help(Inner(), "~"),
            "  ~share [0.5]                     of the whole, in (0, 1)\n");
  EXPECT_NE(field_help(Outer(), "").find("of the pool: round or square\n"), std::string::npos);
}

}  // namespace threelink_fields_test
