// Strokes: played, as files, differentiated.
#include <cmath>
#include <fstream>

#include <gtest/gtest.h>

#include "reference_data.hpp"
#include "threelink_sim/parameter_map.hpp"
#include "threelink_sim/random.hpp"
#include "threelink_sim/stroke_file.hpp"
#include "threelink_sim/stroke_gradient.hpp"

namespace threelink_tests {
namespace {

using namespace threelink_sim;

TEST(Stroke, SquareStrokesOfThePaper) {
  const Model model;
  const auto strokes = reference("strokes", "strokes");
  ASSERT_EQ(strokes.size(), 3u);
  for (const auto& wanted : strokes) {
    if (wanted["order"] != "CW") continue;
    for (int pieces : {4, 240}) {
      const Stroke stroke = square_stroke(model, value(wanted["lo"]), value(wanted["hi"]), pieces);
      const StrokeMeasures m = measure(stroke);
      EXPECT_NEAR(stroke.period(), value(wanted["period"]), 1e-13);
      EXPECT_NEAR(m.displacement.x(), value(wanted["dx_centroid"]), 1e-11);
      EXPECT_NEAR(m.displacement.y(), value(wanted["dy_centroid"]), 1e-11);
      EXPECT_NEAR(m.rotation, value(wanted["net_rotation"]), 1e-11);
      EXPECT_NEAR(m.work, value(wanted["work_per_cycle"]), 1e-11);
    }
  }
}

TEST(Stroke, AlignedStartGoesAlongX) {
  Stroke stroke = square_stroke(Model{}, -1, 1, 40);
  std::rotate(stroke.rates.begin(), stroke.rates.begin() + 15, stroke.rates.end());
  stroke.start = hinge_angles(square_stroke(Model{}, -1, 1, 40))[15];
  stroke.validate();
  SwimmerState state = aligned_start(stroke);
  for (const HingeVector& rates : stroke.rates) advance(stroke.model, state, rates, stroke.dt, 2);
  EXPECT_GT(state.centroid.x(), 0.05);
  EXPECT_NEAR(state.centroid.y(), 0, 1e-14);
}

TEST(Stroke, Refusals) {
  const auto refused = [](Stroke stroke, const std::string& text) {
    try {
      stroke.validate();
      ADD_FAILURE() << "accepted, and should say: " << text;
    } catch (const std::invalid_argument& error) {
      EXPECT_NE(std::string(error.what()).find(text), std::string::npos) << error.what();
    }
  };
  const Stroke good = square_stroke(Model{}, -1, 1, 8);
  Stroke stroke = good;
  stroke.rates.clear();
  refused(stroke, "there are none");
  stroke = good;
  stroke.rates[2][0] = 1.5;
  refused(stroke, "row 3: must be within [-1, 1]");
  stroke = good;
  stroke.rates[2] = HingeVector::Zero(3);
  refused(stroke, "row 3: 3 values");
  stroke = good;
  stroke.rates[2][1] += 1e-3;
  refused(stroke, "must be closed");
  stroke = good;
  stroke.model.joint_limit = 1.0 - 1e-6;
  refused(stroke, "alpha_1");
  stroke = good;
  stroke.dt = 0;
  refused(stroke, "dt = 0");
  EXPECT_THROW(square_stroke(Model{}, 1, -1, 8), std::invalid_argument);
  EXPECT_THROW(square_stroke(Model{}, -1, 1, 6), std::invalid_argument);
  EXPECT_THROW(square_stroke(Model{}, -1, 3, 8), std::invalid_argument);
}

// A stroke that is neither closed nor symmetric.
StrokeVariables some_stroke(const Model& model, int pieces) {
  Random random(7, Stream::kStroke, 0);
  StrokeVariables x;
  x.dt = 0.13;
  x.start.resize(model.hinges());
  x.rates.resize(model.hinges(), pieces);
  for (Eigen::Index j = 0; j < x.start.size(); ++j) x.start[j] = random.uniform(-1, 1);
  for (Eigen::Index i = 0; i < x.rates.size(); ++i) x.rates.data()[i] = random.uniform(-1, 1);
  return x;
}

Stroke as_stroke(const Model& model, const StrokeVariables& x) {
  Stroke stroke;
  stroke.model = model;
  stroke.dt = x.dt;
  stroke.start = x.start;
  for (Eigen::Index k = 0; k < x.rates.cols(); ++k) stroke.rates.push_back(x.rates.col(k));
  return stroke;
}

TEST(StrokeGradient, ValuesAreThoseOfThePlayedStroke) {
  for (int links : {3, 4, 9}) {
    Model model;
    model.links = links;
    const StrokeVariables x = some_stroke(model, 12);
    const StrokeOutcome outcome = stroke_outcome(model, x);
    const StrokeMeasures played = measure(as_stroke(model, x));
    EXPECT_NEAR(outcome.distance.value, played.displacement.norm(), 1e-12);
    EXPECT_NEAR(outcome.rotation.value, played.rotation, 1e-12);
    EXPECT_NEAR(outcome.work.value, played.work, 1e-12);
  }
}

// Central differences of step h err by h^2 f'''/6, here below 1e-9 for h = 1e-5 and third
// derivatives of order one, and by rounding, 1e-16 / h.
TEST(StrokeGradient, DerivativesAreThoseOfDifferences) {
  constexpr double kStep = 1e-5, kTolerance = 1e-9;
  for (int links : {3, 4, 6}) {
    Model model;
    model.links = links;
    model.gamma = 0.6;
    StrokeVariables x = some_stroke(model, 7);
    const StrokeOutcome outcome = stroke_outcome(model, x);
    const auto check = [&](double& variable, double distance, double rotation, double work) {
      const double kept = variable;
      variable = kept + kStep;
      const StrokeOutcome up = stroke_outcome(model, x);
      variable = kept - kStep;
      const StrokeOutcome down = stroke_outcome(model, x);
      variable = kept;
      const auto slope = [&](const StrokeQuantity& a, const StrokeQuantity& b) {
        return (a.value - b.value) / (2 * kStep);
      };
      EXPECT_NEAR(distance, slope(up.distance, down.distance), kTolerance);
      EXPECT_NEAR(rotation, slope(up.rotation, down.rotation), kTolerance);
      EXPECT_NEAR(work, slope(up.work, down.work), kTolerance);
    };
    const StrokeVariables &d = outcome.distance.by, &r = outcome.rotation.by, &w = outcome.work.by;
    check(x.dt, d.dt, r.dt, w.dt);
    for (int j = 0; j < model.hinges(); ++j) {
      check(x.start[j], d.start[j], r.start[j], w.start[j]);
      for (Eigen::Index k = 0; k < x.rates.cols(); ++k)
        check(x.rates(j, k), d.rates(j, k), r.rates(j, k), w.rates(j, k));
    }
  }
}

class StrokeFile : public testing::Test {
 protected:
  void refused(const std::string& text, const std::string& reason) {
    std::ofstream(path_) << text;
    try {
      load_stroke(path_);
      ADD_FAILURE() << "accepted, and should say: " << reason;
    } catch (const UsageError& error) {
      EXPECT_EQ(std::string(error.what()).rfind(path_, 0), 0u);
      EXPECT_NE(std::string(error.what()).find(reason), std::string::npos) << error.what();
    }
  }
  void TearDown() override { std::remove(path_.c_str()); }

  const std::string path_ = testing::TempDir() + "stroke_test.json";
};

TEST_F(StrokeFile, WhatIsWrittenIsRead) {
  const Stroke stroke = square_stroke(Model{}, -0.3, 1.1, 20);
  std::ofstream(path_) << stroke_to_json(stroke, aligned_start(stroke));
  const Stroke read = load_stroke(path_);
  EXPECT_EQ(read.model.links, stroke.model.links);
  EXPECT_EQ(read.model.gamma, stroke.model.gamma);
  EXPECT_EQ(read.model.joint_limit, stroke.model.joint_limit);
  EXPECT_EQ(read.dt, stroke.dt);
  EXPECT_EQ(read.start, stroke.start);
  EXPECT_EQ(read.rates, stroke.rates);
}

TEST_F(StrokeFile, Refusals) {
  const Stroke stroke = square_stroke(Model{}, -1, 1, 8);
  nlohmann::json good = stroke_to_json(stroke, aligned_start(stroke)), bad = good;
  bad["format"] = "something else";
  refused(bad.dump(), "format = \"something else\": must be \"threelink-stroke-1\"");
  bad = good;
  bad.erase("dt");
  refused(bad.dump(), "dt");
  bad = good;
  bad["gamma"] = "half";
  refused(bad.dump(), "gamma = \"half\": must be a number");
  bad = good;
  bad["links"] = 3.5;
  refused(bad.dump(), "links = 3.5: must be a whole number");
  bad["links"] = 4294967299;  // 3 and 2^32
  refused(bad.dump(), "links = 4294967299: must be a whole number");
  bad = good;
  bad["start"]["alpha"] = 1;
  refused(bad.dump(), "start.alpha = 1: must be a list of numbers");
  bad = good;
  bad["rates"][1][1] = nullptr;
  refused(bad.dump(), "rates, row 2 = [");
  bad = good;
  bad["rates"][3][0] = 2;
  refused(bad.dump(), "rates, row 4");
  bad = good;
  bad["links"] = 4;
  refused(bad.dump(), "4 links have 3 hinges");
  refused(good.dump().substr(0, 100), "is not JSON: line 1, column 101, where the text ends");
  refused("{\"dt\": 1, " + good.dump().substr(1), "has the key \"dt\" twice");
  refused("[1]", "has no \"format\"");
  refused("version https://git-lfs.github.com/spec/v1\n", "git lfs pull");
  std::string deep = good.dump();
  const std::string gamma = "\"gamma\":";
  deep.insert(deep.find(gamma) + gamma.size(), std::string(100'000, '['));
  refused(deep, "is nested more than 32 deep");
  EXPECT_THROW(load_stroke("/no/such/file"), UsageError);
}

}  // namespace
}  // namespace threelink_tests
