// The simulator node over its topics, with both peers played by the test; see simulator.test.
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <functional>
#include <limits>
#include <map>
#include <string>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <geometry_msgs/PointStamped.h>
#include <geometry_msgs/PoseStamped.h>
#include <gtest/gtest.h>
#include <nav_msgs/Path.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>
#include <threelink_msgs/Episode.h>
#include <threelink_msgs/HingeRates.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/Reset.h>
#include <threelink_msgs/SwimmerState.h>
#include <visualization_msgs/MarkerArray.h>

#include "threelink_sim/environment.hpp"
#include "threelink_sim/lockstep.hpp"
#include "threelink_sim/random.hpp"

namespace threelink_sim {
namespace {

using threelink_msgs::Observation;
using State = threelink_msgs::SwimmerState;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();
// As in simulator.test.
constexpr double kLengthScale = 2;            // [m] of one L
constexpr double kTimeScale = 4;              // [s] of one T0
constexpr std::uint64_t kTick = 400'000'000;  // [ns] of one step, 0.1 T0
constexpr double kRewardC = 4;
constexpr char kHardwareId[] = "threelink_simulator";

bool finite(const State& state) {
  bool all = std::isfinite(state.power) && std::isfinite(state.work) &&
             std::isfinite(state.reward) && std::isfinite(state.x_1[0]) &&
             std::isfinite(state.x_1[1]) && std::isfinite(state.centroid[0]) &&
             std::isfinite(state.centroid[1]);
  for (double x : state.theta) all = all && std::isfinite(x);
  for (double x : state.alpha) all = all && std::isfinite(x);
  return all;
}

class SimulatorTest : public testing::Test {
 protected:
  SimulatorTest()
      : target_(node_.advertise<geometry_msgs::PointStamped>("target", 10000)),
        rates_(node_.advertise<threelink_msgs::HingeRates>("hinge_rates", 10000)),
        episode_(node_.advertise<threelink_msgs::Episode>("episode", 10)),
        reset_(node_.serviceClient<threelink_msgs::Reset>("reset")) {
    subscribe<State>("state", [this](const State& message) { states_.push_back(message); });
    subscribe<Observation>("observation", [this](const Observation& m) { observation_ = m; });
    subscribe<sensor_msgs::JointState>("joint_states", [this](const auto& m) { joints_ = m; });
    subscribe<geometry_msgs::PoseStamped>("pose", [this](const auto& m) { pose_ = m; });
    subscribe<tf2_msgs::TFMessage>("/tf", [this](const auto& m) { transforms_ = m; });
    subscribe<rosgraph_msgs::Clock>("/clock", [this](const auto& m) { clock_ = m.clock; });
    subscribe<diagnostic_msgs::DiagnosticArray>("/diagnostics", [this](const auto& m) { keep(m); });
    EXPECT_TRUE(reset_.waitForExistence(ros::Duration(10)));
    EXPECT_TRUE(wait([this] {
      return target_.getNumSubscribers() == 1 && rates_.getNumSubscribers() == 1 &&
             episode_.getNumSubscribers() == 1;
    }));
    for (const ros::Subscriber& subscriber : subscribers_)
      EXPECT_TRUE(wait([&] { return subscriber.getNumPublishers() >= 1; }));
  }

  template <class Message>
  void subscribe(const char* topic, const std::function<void(const Message&)>& callback) {
    subscribers_.push_back(node_.subscribe<Message>(
        topic, 1000,
        boost::function<void(const boost::shared_ptr<const Message>&)>(
            [callback](const boost::shared_ptr<const Message>& m) { callback(*m); }),
        ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
  }

  static bool wait(const std::function<bool()>& condition, double seconds = 10) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!condition()) {
      if (std::chrono::steady_clock::now() > end) return false;
      ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
    }
    return true;
  }

  void keep(const diagnostic_msgs::DiagnosticArray& array) {
    for (const auto& status : array.status) {
      if (status.hardware_id != kHardwareId) continue;
      for (const auto& item : status.values) diagnostics_[item.key] = item.value;
      message_ = status.message;
    }
  }

  // Waits until the counter has reached a value; the counters go on from test to test.
  void expect_count(const std::string& key, unsigned long value) {
    EXPECT_TRUE(wait([&] { return count(key) == value; }))
        << key << " is " << count(key) << " and not " << value;
  }
  unsigned long count(const std::string& key) {
    return diagnostics_.count(key) ? std::stoul(diagnostics_[key]) : ~0ul;
  }
  void await_diagnostics() {
    diagnostics_.clear();
    ASSERT_TRUE(wait([&] { return !diagnostics_.empty(); }));
  }

  threelink_msgs::Reset::Response reset(const threelink_msgs::Reset::Request& request = {}) {
    threelink_msgs::Reset call;
    call.request = request;
    EXPECT_TRUE(reset_.call(call));
    return call.response;
  }
  // Starts an episode; the state is the last of states_.
  void begin(const threelink_msgs::Reset::Request& request = {}) {
    const auto response = reset(request);
    ASSERT_TRUE(response.success) << response.status;
    ASSERT_TRUE(await(response.state.episode, 0));
  }
  bool await(std::uint32_t episode, std::uint64_t step) {
    return wait(
        [&] { return !states_.empty() && state().episode == episode && state().step == step; });
  }
  const State& state() const { return states_.back(); }

  // [L]
  void send_target(double x, double y) {
    geometry_msgs::PointStamped message;
    message.header.frame_id = "world";
    message.header.stamp = state().header.stamp;
    message.point.x = x * kLengthScale;
    message.point.y = y * kLengthScale;
    target_.publish(message);
  }
  bool await_observation() {
    return wait([&] {
      return observation_.episode == state().episode && observation_.step == state().step;
    });
  }
  threelink_msgs::HingeRates command(const std::vector<double>& rates) const {
    threelink_msgs::HingeRates message;
    message.episode = state().episode;
    message.step = state().step;
    message.rates = rates;
    return message;
  }
  // A whole step of both peers.
  void step(const std::vector<double>& rates, double x = 2, double y = 1) {
    const std::uint32_t episode = state().episode;
    const std::uint64_t k = state().step;
    send_target(x, y);
    ASSERT_TRUE(await_observation());
    rates_.publish(command(rates));
    ASSERT_TRUE(await(episode, k + 1));
  }

  ros::NodeHandle node_{"threelink"};
  ros::Publisher target_, rates_, episode_;
  ros::ServiceClient reset_;
  std::vector<ros::Subscriber> subscribers_;
  std::deque<State> states_;
  Observation observation_;
  sensor_msgs::JointState joints_;
  geometry_msgs::PoseStamped pose_;
  tf2_msgs::TFMessage transforms_;
  ros::Time clock_;
  std::map<std::string, std::string> diagnostics_;
  std::string message_;
};

TEST_F(SimulatorTest, AnEpisodeOverTopicsIsTheOneInProcess) {
  threelink_msgs::Reset::Request request;
  request.random_start = true;
  request.seed = 7;
  begin(request);
  EnvironmentConfig config;
  config.c = kRewardC;
  Environment environment(config, 1);
  environment.reset(0, random_start(config.model, 7, state().episode));
  Random random(1, Stream::kExploration, 1);
  const ros::Time start = state().header.stamp;

  for (int k = 0; k < 300; ++k) {
    const SwimmerState expected = environment.batch().state(0);
    ASSERT_EQ(state().centroid[0], expected.centroid.x());
    ASSERT_EQ(state().centroid[1], expected.centroid.y());
    ASSERT_EQ(state().theta[1], expected.heading);
    ASSERT_EQ(state().alpha[0], expected.alpha[0]);
    ASSERT_EQ(state().alpha[1], expected.alpha[1]);
    ASSERT_EQ(state().header.frame_id, "world");
    ASSERT_EQ((state().header.stamp - start).toNSec(), k * kTick);

    const Eigen::Vector2d target(2 - 0.01 * k, 1);
    const std::vector<double> rates = {random.uniform(-1, 1), random.uniform(-1, 1)};
    step(rates, target.x(), target.y());
    environment.aim(0, target);
    const Eigen::Vector2d p = environment.direction(0);
    double values[4];
    environment.observe(values);
    ASSERT_EQ(observation_.kind, "direction");
    ASSERT_EQ(observation_.values, std::vector<double>(values, values + 4));
    ASSERT_EQ(observation_.distance, environment.distance(0));
    ASSERT_DOUBLE_EQ(observation_.theta_t, std::atan2(p.y(), p.x()));

    environment.step(rates.data());
    ASSERT_EQ(state().hinge_rates[0], environment.batch().rates(0)[0]);
    ASSERT_EQ(state().hinge_rates[1], environment.batch().rates(1)[0]);
    ASSERT_EQ(state().work, environment.batch().work()[0]);
    ASSERT_EQ(state().reward, environment.rewards()[0]);
    ASSERT_GT(state().power, 0);
  }
}

TEST_F(SimulatorTest, StandardMessagesFollowTheState) {
  threelink_msgs::Reset::Request request;
  request.x_1 = {1.0, 0.5};
  request.theta_1 = 0.3;
  request.alpha = {-0.5, 0.8};
  begin(request);
  EXPECT_NEAR(state().x_1[0], 1.0, 1e-15);
  EXPECT_NEAR(state().x_1[1], 0.5, 1e-15);
  EXPECT_NEAR(state().theta[0], 0.3, 1e-15);
  EXPECT_EQ(state().hinge_rates, (std::vector<double>{0, 0}));
  EXPECT_EQ(state().work, 0);
  step({0.5, -1});
  const State now = state();
  const ros::Time stamp = now.header.stamp;
  ASSERT_TRUE(wait([&] { return joints_.header.stamp == stamp && pose_.header.stamp == stamp; }));
  ASSERT_TRUE(wait([&] {
    return clock_ == stamp && !transforms_.transforms.empty() &&
           transforms_.transforms[0].header.stamp == stamp;
  }));

  EXPECT_EQ(joints_.name, (std::vector<std::string>{"hinge_1", "hinge_2"}));
  EXPECT_EQ(joints_.position, now.alpha);
  EXPECT_EQ(joints_.velocity, (std::vector<double>{0.5 / kTimeScale, -1.0 / kTimeScale}));
  EXPECT_EQ(pose_.header.frame_id, "world");
  EXPECT_EQ(pose_.pose.position.x, kLengthScale * now.centroid[0]);
  EXPECT_EQ(pose_.pose.position.y, kLengthScale * now.centroid[1]);
  EXPECT_NEAR(2 * std::atan2(pose_.pose.orientation.z, pose_.pose.orientation.w), now.theta[1],
              1e-15);

  const auto& transform = transforms_.transforms[0];
  EXPECT_EQ(transform.header.frame_id, "world");
  EXPECT_EQ(transform.child_frame_id, "base_link");
  // x_1, link 1, half of link 2.
  EXPECT_NEAR(transform.transform.translation.x,
              kLengthScale * (now.x_1[0] + std::cos(now.theta[0]) / 3 + std::cos(now.theta[1]) / 6),
              1e-14);
  EXPECT_NEAR(transform.transform.translation.y,
              kLengthScale * (now.x_1[1] + std::sin(now.theta[0]) / 3 + std::sin(now.theta[1]) / 6),
              1e-14);
  EXPECT_EQ(transform.transform.rotation.z, pose_.pose.orientation.z);
}

TEST_F(SimulatorTest, TheViewShowsTheSwimmer) {
  visualization_msgs::MarkerArray markers;
  nav_msgs::Path path;
  subscribe<visualization_msgs::MarkerArray>("markers", [&](const auto& m) { markers = m; });
  subscribe<nav_msgs::Path>("swimmer_path", [&](const auto& m) { path = m; });
  begin();
  for (int k = 0; k < 80; ++k) step({k % 2 ? 0.5 : -0.5, 0.1}, 3, 0);
  const auto find = [&](const std::string& name, int id) {
    for (const auto& marker : markers.markers)
      if (marker.ns == name && marker.id == id) return marker;
    return visualization_msgs::Marker();
  };
  ASSERT_TRUE(wait([&] {
    return !markers.markers.empty() && find("text", 0).header.stamp == state().header.stamp &&
           path.header.stamp == state().header.stamp;
  }));
  for (int i = 0; i < 3; ++i) {
    const auto link = find("links", i);
    EXPECT_NEAR(link.scale.x, kLengthScale / 3, 1e-15);
    EXPECT_NEAR(2 * std::atan2(link.pose.orientation.z, link.pose.orientation.w), state().theta[i],
                1e-15);
  }
  EXPECT_NEAR(find("links", 0).pose.position.x,
              kLengthScale * (state().x_1[0] + std::cos(state().theta[0]) / 6), 1e-15);
  EXPECT_EQ(find("centroid", 0).pose.position.y, kLengthScale * state().centroid[1]);
  EXPECT_EQ(find("target", 0).pose.position.x, 3 * kLengthScale);
  const auto trail = find("trail", 0);
  ASSERT_EQ(trail.points.size(), 81u);
  ASSERT_EQ(trail.colors.size(), 81u);
  EXPECT_LT(trail.colors.front().a, trail.colors.back().a) << "it fades";
  ASSERT_EQ(path.poses.size(), 81u);
  EXPECT_EQ(path.poses.back().pose.position.x, kLengthScale * state().centroid[0]);

  const std::string text = find("text", 0).text;
  const Eigen::Vector2d now(state().centroid[0], state().centroid[1]);
  const State& old = states_[states_.size() - 71];
  const double speed = (now - Eigen::Vector2d(old.centroid[0], old.centroid[1])).norm() / 7;
  double work = 0;
  for (std::size_t i = states_.size() - 70; i < states_.size(); ++i) work += states_[i].work;
  char expected[200];
  std::snprintf(expected, sizeof(expected),
                "episode %u  step 80\ndistance %.4g L\nspeed %.4f L/T0\nefficiency %.2f %%",
                state().episode, (now - Eigen::Vector2d(3, 0)).norm(), speed,
                100 * 0.5 * speed * speed * 7 / work);
  EXPECT_EQ(text, expected);

  begin();
  ASSERT_TRUE(wait([&] { return path.poses.size() == 1; }));
  EXPECT_EQ(markers.markers[0].action, visualization_msgs::Marker::DELETEALL);
}

TEST_F(SimulatorTest, ARateThatWouldPassTheJointLimitLandsOnIt) {
  begin();
  const double limit = 2 * kPi / 3;
  for (int k = 0; k < 20; ++k) step({1, -1});
  EXPECT_NEAR(state().alpha[0], 2.0, 1e-14);
  const double gap = limit - state().alpha[0];
  step({1, -1});
  EXPECT_EQ(state().alpha[0], limit);
  EXPECT_EQ(state().alpha[1], -limit);
  EXPECT_NEAR(state().hinge_rates[0], gap / 0.1, 1e-12);
  EXPECT_NEAR(state().hinge_rates[1], -gap / 0.1, 1e-12);
  step({1, 1});
  EXPECT_EQ(state().alpha[0], limit);
  EXPECT_EQ(state().hinge_rates[0], 0);
  EXPECT_EQ(state().hinge_rates[1], 1);
}

TEST_F(SimulatorTest, AStateIsTakenWithoutRounding) {
  threelink_msgs::Reset::Request request;
  request.from_centroid = true;
  request.centroid = {0.1, -0.7};
  request.heading = 1.0 / 3;
  request.alpha = {-0.3, 1.1};
  begin(request);
  EXPECT_EQ(state().centroid[0], 0.1);
  EXPECT_EQ(state().centroid[1], -0.7);
  EXPECT_EQ(state().theta[1], 1.0 / 3);
  EXPECT_EQ(state().alpha, request.alpha);
  request.heading = kNan;
  EXPECT_NE(reset(request).status.find("heading"), std::string::npos);
  request.heading = 0;
  request.centroid[1] = 1e308;
  EXPECT_NE(reset(request).status.find("centroid"), std::string::npos);
}

TEST_F(SimulatorTest, ResetRefusesWhatIsNoState) {
  begin();
  await_diagnostics();
  const unsigned long before = count("reset refused");
  const std::uint32_t episode = state().episode;
  const auto refused = [&](const std::string& field, std::array<double, 2> x_1, double theta_1,
                           const std::vector<double>& alpha) {
    threelink_msgs::Reset::Request request;
    request.x_1 = {x_1[0], x_1[1]};
    request.theta_1 = theta_1;
    request.alpha = alpha;
    const auto response = reset(request);
    EXPECT_FALSE(response.success) << field;
    EXPECT_NE(response.status.find(field), std::string::npos) << response.status;
  };
  refused("x_1", {kNan, 0}, 0, {});
  refused("x_1", {0, -kInfinity}, 0, {});
  refused("x_1", {0, 1e308}, 0, {});
  refused("theta_1", {0, 0}, kNan, {});
  refused("theta_1", {0, 0}, 1e300, {});
  refused("alpha has 1", {0, 0}, 0, {0.1});
  refused("alpha has 3", {0, 0}, 0, {0.1, 0.1, 0.1});
  refused("alpha_2", {0, 0}, 0, {0.1, kNan});
  refused("alpha_1", {0, 0}, 0, {2.1, 0});
  expect_count("reset refused", before + 9);
  // The episode that was running goes on.
  EXPECT_EQ(state().episode, episode);
  step({0.1, 0.2});
  const auto response = reset();
  EXPECT_TRUE(response.success);
  EXPECT_EQ(response.state.episode, episode + 1);
}

TEST_F(SimulatorTest, RefusesAndCountsBadMessages) {
  begin();
  step({0.3, 0.4});
  await_diagnostics();
  const auto baseline = diagnostics_;
  const State before = state();
  send_target(2, 1);
  ASSERT_TRUE(await_observation());

  // Thousands of each kind, at once.
  constexpr int kRounds = 400;
  std::map<std::string, unsigned long> expected;
  const auto refuse_rates = [&](const std::string& reason,
                                const threelink_msgs::HingeRates& rates) {
    rates_.publish(rates);
    ++expected["hinge_rates refused: " + reason];
  };
  for (int round = 0; round < kRounds; ++round) {
    refuse_rates("not finite", command({kNan, 0}));
    refuse_rates("not finite", command({0, round % 2 ? kInfinity : -kInfinity}));
    refuse_rates("out of range", command({1e308, 0}));
    refuse_rates("out of range", command({0, std::nextafter(-1.0, -2.0)}));
    refuse_rates("wrong length", command({}));
    refuse_rates("wrong length", command(std::vector<double>(1 + 2 * (round % 50), 0.1)));
    threelink_msgs::HingeRates rates = command({0.1, 0.1});
    rates.step = before.step - 1;
    refuse_rates("stale", rates);
    rates.step = before.step + 1 + round;
    refuse_rates("future", rates);
    rates.step = before.step;
    rates.episode = before.episode + 1;
    refuse_rates("future", rates);
  }
  const auto refuse_target = [&](const std::string& reason, const std::string& frame, double x,
                                 double y, ros::Duration offset) {
    geometry_msgs::PointStamped message;
    message.header.frame_id = frame;
    message.header.stamp = before.header.stamp + offset;
    message.point.x = x;
    message.point.y = y;
    target_.publish(message);
    ++expected["target refused: " + reason];
  };
  const ros::Duration now(0), tick(0, kTick);
  for (int round = 0; round < kRounds; ++round) {
    refuse_target("not finite", "world", kNan, 0, now);
    refuse_target("not finite", "world", 0, kInfinity, now);
    refuse_target("wrong frame", "map", 0, 0, now);
    refuse_target("wrong frame", "", 0, 0, now);
    refuse_target("stale", "world", 0, 0, now);
    refuse_target("stale", "world", 0, 0, -tick);
    refuse_target("future", "world", 0, 0, tick);
  }
  for (const auto& item : expected)
    expect_count(item.first, std::stoul(baseline.at(item.first)) + item.second);
  EXPECT_EQ(diagnostics_["step"], std::to_string(before.step)) << "nothing of it moved the swimmer";
  EXPECT_EQ(state().step, before.step);

  // A good command, of denormal rates, is still obeyed.
  rates_.publish(command({5e-324, -1e-310}));
  ASSERT_TRUE(await(before.episode, before.step + 1));
  EXPECT_TRUE(finite(state()));
  EXPECT_EQ(state().alpha, before.alpha);
}

TEST_F(SimulatorTest, EveryFiniteTargetHasADirection) {
  begin();
  const auto direction = [this] {
    const double heading = state().theta[1];
    const double c = observation_.values[0], s = observation_.values[1];
    return Eigen::Vector2d(c * std::cos(heading) + s * std::sin(heading),
                           c * std::sin(heading) - s * std::cos(heading));
  };
  const auto aim_and_step = [&](double x, double y) {
    step({0.5, -0.5}, x, y);
    ASSERT_TRUE(finite(state()));
    ASSERT_TRUE(std::isfinite(observation_.distance));
  };
  // On the centroid: the direction of before, (1, 0) at first.
  aim_and_step(state().centroid[0], state().centroid[1]);
  EXPECT_EQ(observation_.distance, 0);
  EXPECT_EQ(observation_.theta_t, 0);
  aim_and_step(0, -8e307);
  EXPECT_NEAR(observation_.theta_t, -kPi / 2, 1e-15);
  EXPECT_EQ(observation_.distance, 8e307);
  const double theta_t = observation_.theta_t;
  aim_and_step(state().centroid[0], state().centroid[1]);
  EXPECT_EQ(observation_.theta_t, theta_t);
  aim_and_step(5e307, 5e307);
  EXPECT_NEAR(observation_.theta_t, kPi / 4, 1e-15);
  send_target(3, 4);
  ASSERT_TRUE(await_observation());
  EXPECT_NEAR(direction().norm(), 1, 1e-15);
}

TEST_F(SimulatorTest, TheEndOfTheEpisodeMakesItIdle) {
  begin();
  step({0.1, 0.1});
  send_target(2, 1);
  ASSERT_TRUE(await_observation());
  await_diagnostics();
  const unsigned long stale = count("hinge_rates refused: stale");

  threelink_msgs::Episode message;
  message.status = threelink_msgs::Episode::TIMED_OUT;
  message.episode = state().episode - 1;
  episode_.publish(message);  // of another episode: nothing
  message.episode = state().episode;
  message.status = threelink_msgs::Episode::STARTED;
  episode_.publish(message);  // no end
  message.status = threelink_msgs::Episode::CAPTURED;
  episode_.publish(message);
  ASSERT_TRUE(wait([&] { return message_ == "idle: waiting for a reset"; }));
  rates_.publish(command({0.2, 0.2}));
  expect_count("hinge_rates refused: stale", stale + 1);
  EXPECT_EQ(state().step, 1u);

  const ros::Time stamp = state().header.stamp;
  begin();
  EXPECT_EQ(state().header.stamp.toNSec(), stamp.toNSec() + kTick) << "time goes on";
}

}  // namespace
}  // namespace threelink_sim

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "simulator_test");
  ros::start();
  const int status = RUN_ALL_TESTS();
  ros::shutdown();
  return status;
}
