// The agent node over its topics, with the simulator and the learner played by the test.
#include <chrono>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <diagnostic_msgs/DiagnosticArray.h>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sys/wait.h>
#include <threelink_msgs/HingeRates.h>
#include <threelink_msgs/LoadPolicy.h>
#include <threelink_msgs/Observation.h>
#include <threelink_msgs/PolicyWeights.h>
#include <unistd.h>

#include "../unit/random_policy.hpp"
#include "threelink_sim/files.hpp"

namespace threelink_tests {
namespace {

using threelink_agent::Policy;
using threelink_agent::Symmetry;
using threelink_msgs::HingeRates;
using threelink_msgs::Observation;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

bool wait(const std::function<bool()>& condition, double seconds = 15) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
  while (!condition()) {
    if (std::chrono::steady_clock::now() > end) return false;
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.01));
  }
  return true;
}

bool contains(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

// agent_node as a process of its own; its output goes to a file.
class AgentProcess {
 public:
  AgentProcess(const std::string& argument, std::string log) : log_(std::move(log)), id_(fork()) {
    if (id_ != 0) return;
    const int file = open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    dup2(file, 1);
    dup2(file, 2);
    execl(AGENT_NODE, AGENT_NODE, "__name:=agent", argument.c_str(), nullptr);
    _exit(127);
  }
  ~AgentProcess() { end(SIGTERM); }

  // The exit status; -1 if a signal ended it.
  int end(int signal) {
    if (id_ > 0) kill(id_, signal);
    return status();
  }
  int status() {
    if (id_ > 0) {
      int raw = 0;
      const bool ended = wait([&] { return waitpid(id_, &raw, WNOHANG) == id_; });
      EXPECT_TRUE(ended);
      if (!ended) kill(id_, SIGKILL);
      status_ = ended && WIFEXITED(raw) ? WEXITSTATUS(raw) : -1;
      id_ = 0;
    }
    return status_;
  }
  std::string output() const { return threelink_sim::read_file(log_, 1 << 20); }

 private:
  std::string log_;
  pid_t id_;
  int status_ = -1;
};

class AgentTest : public testing::Test {
 protected:
  AgentTest()
      : observation_publisher_(node_.advertise<Observation>("observation", 100)),
        policy_publisher_(node_.advertise<threelink_msgs::PolicyWeights>("policy", 10)),
        rates_subscriber_(subscribe_rates()),
        diagnostics_subscriber_(
            node_.subscribe("/diagnostics", 100, &AgentTest::on_diagnostics, this)),
        load_(node_.serviceClient<threelink_msgs::LoadPolicy>("load_policy")) {
    std::filesystem::create_directories(folder_);
  }
  ~AgentTest() override {
    agent_.reset();
    std::filesystem::remove_all(folder_);
  }

  std::string file(const std::string& name) const { return folder_ / name; }

  void start(const Policy& policy) {
    policy.save(file("start.safetensors"));
    agent_ = std::make_unique<AgentProcess>("_policy:=" + file("start.safetensors"), file("log"));
    ASSERT_TRUE(wait([this] {
      return observation_publisher_.getNumSubscribers() == 1 &&
             policy_publisher_.getNumSubscribers() == 1 &&
             rates_subscriber_.getNumPublishers() == 1 && load_.exists();
    }));
  }

  // Each observation has a step of its own, except where one is repeated.
  Observation observation(std::vector<double> values) {
    Observation message;
    message.header.stamp.fromNSec(1'000'000'007 + step_);
    message.episode = 3;
    message.step = ++step_;
    message.kind = Observation::DIRECTION;
    message.values = std::move(values);
    return message;
  }

  void expect_answer(const Policy& policy, const Observation& observation) {
    observation_publisher_.publish(observation);
    ASSERT_TRUE(
        wait([&] { return !answers_.empty() && answers_.back().step == observation.step; }));
    const HingeRates& answer = answers_.back();
    EXPECT_EQ(answer.episode, observation.episode);
    EXPECT_EQ(answer.header.stamp, observation.header.stamp);
    EXPECT_EQ(answer.policy, policy.id());
    std::vector<double> rates(policy.hinges());
    if (policy.metadata().sampled) {
      const auto step = static_cast<std::uint32_t>(observation.step);
      policy.sample(observation.values.data(), {0, observation.episode, step}, rates.data());
    } else {
      policy.act(observation.values.data(), rates.data());
    }
    ASSERT_EQ(answer.rates.size(), rates.size());
    EXPECT_EQ(std::memcmp(answer.rates.data(), rates.data(), rates.size() * sizeof(double)), 0);
  }
  void expect_in_use(const Policy& policy) {
    expect_answer(policy, observation({0.6, 0.8, 0.3, -0.2}));
  }

  std::string load(const std::string& path, bool success, const Policy& in_use) {
    threelink_msgs::LoadPolicy call;
    call.request.file = path;
    EXPECT_TRUE(load_.call(call));
    EXPECT_EQ(call.response.success, success) << call.response.status;
    EXPECT_EQ(call.response.sha256, in_use.sha256());
    return call.response.status;
  }

  ros::Subscriber subscribe_rates() {
    return node_.subscribe("hinge_rates", 100, &AgentTest::on_rates, this);
  }
  void on_rates(const HingeRates& rates) { answers_.push_back(rates); }
  void on_diagnostics(const diagnostic_msgs::DiagnosticArray& array) {
    for (const auto& status : array.status)
      if (status.hardware_id == "threelink_agent") status_ = status;
  }
  std::string diagnostic(const std::string& key) const {
    for (const auto& value : status_.values)
      if (value.key == key) return value.value;
    return "none";
  }

  const std::filesystem::path folder_ =
      std::filesystem::temp_directory_path() / ("agent_test_" + std::to_string(getpid()));
  std::unique_ptr<AgentProcess> agent_;
  std::vector<HingeRates> answers_;
  diagnostic_msgs::DiagnosticStatus status_;
  std::uint64_t step_ = 0;

  ros::NodeHandle node_;
  ros::Publisher observation_publisher_, policy_publisher_;
  ros::Subscriber rates_subscriber_, diagnostics_subscriber_;
  ros::ServiceClient load_;
};

TEST_F(AgentTest, AnswersAsThePolicyActs) {
  const Policy policy = random_policy(1);
  start(policy);
  constexpr std::size_t kCount = 50;
  const std::vector<double> all = random_observations(kCount, 2, 1);
  for (std::size_t i = 0; i < kCount; ++i)
    expect_answer(policy,
                  observation({all[i], all[kCount + i], all[2 * kCount + i], all[3 * kCount + i]}));
  // A repeated observation gets the same answer, and whoever comes late gets the last one.
  Observation again = observation({-1, 0, 0.5, 0.5});
  expect_answer(policy, again);
  const std::size_t before = answers_.size();
  observation_publisher_.publish(again);
  ASSERT_TRUE(wait([&] { return answers_.size() == before + 1; }));
  EXPECT_EQ(answers_[before].rates, answers_[before - 1].rates);
  rates_subscriber_.shutdown();
  answers_.clear();
  rates_subscriber_ = subscribe_rates();
  ASSERT_TRUE(wait([&] { return !answers_.empty(); }));
  EXPECT_EQ(answers_[0].step, again.step);

  ASSERT_TRUE(wait([&] { return status_.message == "idle"; }));
  EXPECT_EQ(status_.level, diagnostic_msgs::DiagnosticStatus::OK);
  EXPECT_EQ(diagnostic("policy sha256"), policy.sha256());
  EXPECT_NE(diagnostic("latency p99 [us]"), "none");
  EXPECT_EQ(agent_->end(SIGTERM), 0);
}

TEST_F(AgentTest, RefusesObservationsThatItsPolicyDoesNotTake) {
  const Policy policy = random_policy(2);
  start(policy);
  Observation wrong_kind = observation({1, 0, 0, 0});
  wrong_kind.kind = "target";
  observation_publisher_.publish(wrong_kind);
  ASSERT_TRUE(wait([&] { return diagnostic("observation refused: wrong kind") == "1"; }));
  EXPECT_EQ(status_.level, diagnostic_msgs::DiagnosticStatus::ERROR);
  EXPECT_TRUE(contains(status_.message, "\"target\"")) << status_.message;
  EXPECT_TRUE(contains(status_.message, "\"direction\"")) << status_.message;

  for (const std::vector<double>& values :
       {std::vector<double>{}, {1, 0, 0}, {1, 0, 0, 0, 0}, std::vector<double>(100000)})
    observation_publisher_.publish(observation(values));
  ASSERT_TRUE(wait([&] { return diagnostic("observation refused: wrong length") == "4"; }));
  EXPECT_TRUE(contains(status_.message, "100000 values")) << status_.message;
  EXPECT_TRUE(contains(status_.message, "takes 4")) << status_.message;

  for (double value : {kNaN, kInfinity, -kInfinity, 1e308})
    for (std::size_t k = 0; k < 4; ++k) {
      Observation message = observation({1, 0, 0, 0});
      message.values[k] = value;
      observation_publisher_.publish(message);
    }
  ASSERT_TRUE(wait([&] { return diagnostic("observation refused: out of range") == "16"; }));
  EXPECT_TRUE(answers_.empty());
  expect_in_use(policy);
  ASSERT_TRUE(wait([&] { return status_.level == diagnostic_msgs::DiagnosticStatus::OK; }));
}

TEST_F(AgentTest, GoesOnWithThePoliciesOfTheLearner) {
  start(random_policy(3));
  threelink_msgs::PolicyWeights weights;
  for (std::uint64_t seed : {4, 5}) {
    const Policy policy = random_policy(seed, Symmetry::kNone);
    weights.version = seed;
    weights.data.assign(policy.serialize().begin(), policy.serialize().end());
    policy_publisher_.publish(weights);
    ASSERT_TRUE(wait([&] { return diagnostic("policy sha256") == policy.sha256(); }));
    expect_in_use(policy);
  }
  const Policy policy = random_policy(5, Symmetry::kNone);
  weights.data[weights.data.size() / 2] ^= 4;
  policy_publisher_.publish(weights);
  ASSERT_TRUE(wait([&] { return diagnostic("policies refused") == "1"; }));
  EXPECT_EQ(status_.level, diagnostic_msgs::DiagnosticStatus::WARN);
  EXPECT_TRUE(contains(status_.message, "version 5: damaged")) << status_.message;
  weights.data.clear();
  policy_publisher_.publish(weights);
  ASSERT_TRUE(wait([&] { return diagnostic("policies refused") == "2"; }));
  EXPECT_EQ(diagnostic("policies loaded"), "2");
  expect_in_use(policy);
}

TEST_F(AgentTest, FollowsATrainingFromEpisodeToEpisode) {
  node_.deleteParam("agent");  // of the nodes before
  agent_ = std::make_unique<AgentProcess>("_follow:=true", file("log"));
  ASSERT_TRUE(wait([&] { return policy_publisher_.getNumSubscribers() == 1; }));
  threelink_msgs::PolicyWeights weights;
  const auto publish = [&](const Policy& policy) {
    ++weights.version;
    weights.data.assign(policy.serialize().begin(), policy.serialize().end());
    policy_publisher_.publish(weights);
  };
  const auto observe = [&](std::uint32_t episode, const Policy& policy) {
    Observation message = observation({0.6, 0.8, 0.3, -0.2});
    message.episode = episode;
    observation_publisher_.publish(message);
    ASSERT_TRUE(wait([&] { return !answers_.empty() && answers_.back().step == message.step; }));
    EXPECT_EQ(answers_.back().policy, policy.id());
  };
  weights.data = {1, 2, 3};
  policy_publisher_.publish(weights);  // it waits for a sound one
  const Policy first = random_policy(3);
  publish(first);
  ASSERT_TRUE(wait([&] { return diagnostic("policy sha256") == first.sha256(); }));
  observe(1, first);
  const Policy second = random_policy(4), third = random_policy(5);
  publish(second);
  publish(third);
  ASSERT_TRUE(wait([&] { return diagnostic("policies loaded") != "0"; }));
  observe(1, first);  // to its end
  std::uint32_t episode = 1;
  ASSERT_TRUE(wait([&] {
    Observation message = observation({0.6, 0.8, 0.3, -0.2});
    message.episode = ++episode;
    observation_publisher_.publish(message);
    return answers_.back().policy == third.id();
  }));
  weights.data[weights.data.size() / 2] ^= 4;
  policy_publisher_.publish(weights);
  ASSERT_TRUE(wait([&] { return diagnostic("policies refused") == "1"; }));
  observe(episode + 1, third);
  agent_->end(SIGTERM);
  node_.deleteParam("agent");
}

TEST_F(AgentTest, PlaysEachPolicyAsItSays) {
  start(random_policy(6));
  const Policy mean = random_policy(7);
  threelink_agent::PolicyMetadata metadata = mean.metadata();
  metadata.sampled = true;
  const Policy sampled(metadata, mean.actor(), mean.log_std());
  for (const Policy& policy : {sampled, mean}) {
    policy.save(file("next.safetensors"));
    load(file("next.safetensors"), true, policy);
    expect_answer(policy, observation({0.6, 0.8, 0.3, -0.2}));
  }
}

TEST_F(AgentTest, LoadsFilesAndKeepsTheOldPolicyIfTheyAreUnsound) {
  start(random_policy(6));
  const Policy policy = random_policy(7);
  policy.save(file("good.safetensors"));
  EXPECT_TRUE(contains(load(file("good.safetensors"), true, policy), policy.id()));
  expect_in_use(policy);

  const std::string bytes = policy.serialize();
  std::string flipped = bytes;
  flipped[flipped.size() - 100] ^= 1;
  threelink_sim::write_file(file("flipped"), flipped);
  EXPECT_TRUE(contains(load(file("flipped"), false, policy), file("flipped") + ": damaged"));
  threelink_sim::write_file(file("short"), bytes.substr(0, bytes.size() / 2));
  EXPECT_TRUE(contains(load(file("short"), false, policy), file("short")));
  threelink_sim::write_file(file("secret"), "secret: of somebody who did not give it away");
  const std::string told = load(file("secret"), false, policy);
  EXPECT_TRUE(contains(told, file("secret") + ": is not a safetensors file")) << told;
  EXPECT_FALSE(contains(told, "of somebody")) << told;
  EXPECT_TRUE(contains(load(file("none"), false, policy), "cannot open"));
  EXPECT_TRUE(contains(load("", false, policy), "cannot open"));

  // Sound, but for another swimmer: both shapes are named.
  random_policy(8, Symmetry::kReversal, 5).save(file("five_links"));
  const std::string status = load(file("five_links"), false, policy);
  for (const char* part : {"5 links", "(64, 6)", "(4, 64)", "3 links", "(64, 4)", "(2, 64)"})
    EXPECT_TRUE(contains(status, part)) << status;
  ASSERT_TRUE(wait([&] { return diagnostic("policies refused") == "6"; }));
  expect_in_use(policy);
}

TEST_F(AgentTest, DoesNotStartWithoutASoundPolicy) {
  const auto refusal = [&](const std::string& argument) {
    AgentProcess agent(argument, file("log"));
    EXPECT_EQ(agent.status(), 2);
    return agent.output();
  };
  std::string text = refusal("_policy:=" + file("none"));
  EXPECT_TRUE(contains(text, "agent/policy")) << text;
  EXPECT_TRUE(contains(text, file("none") + ": cannot open")) << text;
  std::string flipped = random_policy(9).serialize();
  flipped[5000] ^= 1;
  threelink_sim::write_file(file("flipped"), flipped);
  text = refusal("_policy:=" + file("flipped"));
  EXPECT_TRUE(contains(text, "damaged")) << text;
  random_policy(9).save(file("good"));
  text = refusal("_polcy:=" + file("good"));
  // Private parameters stay on the server: the nodes before have left ~policy there.
  EXPECT_TRUE(contains(text, "polcy")) << text;
  node_.deleteParam("agent");
  text = refusal("_other:=1");
  EXPECT_TRUE(contains(text, "agent/policy is missing")) << text;
}

}  // namespace
}  // namespace threelink_tests

int main(int argc, char** argv) {
  testing::InitGoogleTest(&argc, argv);
  ros::init(argc, argv, "agent_test");
  ros::start();
  return RUN_ALL_TESTS();
}
