// rosrun threelink_agent status: a live view of a training on the terminal.
#include <chrono>
#include <cstdio>
#include <optional>
#include <string>
#include <vector>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <ros/callback_queue.h>
#include <ros/init.h>
#include <ros/node_handle.h>
#include <unistd.h>

#include "status_view.hpp"
#include "threelink_sim/node/intake.hpp"
#include "threelink_sim/node/node_main.hpp"
#include "threelink_sim/node/topics.hpp"

namespace threelink_agent {
namespace {

constexpr double kPeriod = 1.0;  // [s] from one picture to the next

// Shows text on standard output: in place of the last on a terminal, below it elsewhere.
class Screen {
 public:
  bool terminal() const { return terminal_; }

  void show(const std::vector<std::string>& lines) {
    std::string text;
    if (terminal_ && height_ > 0) text += fmt::format("\033[{}A", height_);
    if (terminal_) text += "\r\033[J";
    for (const std::string& line : lines) text += line + "\n";
    height_ = lines.size();
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
  }

 private:
  bool terminal_ = isatty(STDOUT_FILENO);
  std::size_t height_ = 0;
};

class View {
 public:
  View() {
    subscriber_ = threelink_sim::subscribe<threelink_msgs::TrainingStatus>(
        node_, threelink_sim::topics::kTrainingStatus, 10, threelink_sim::message_size::kSmall,
        nullptr, [this](const auto& event) { on_status(event); });
  }

  // Until the training has finished, or the node has to end.
  int run() {
    while (threelink_sim::running() && !finished()) {
      show();
      const auto next = Clock::now() + std::chrono::duration<double>(kPeriod);
      while (threelink_sim::running() && !finished() && Clock::now() < next)
        ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.05));
    }
    if (finished()) show();
    return threelink_sim::kSuccess;
  }

 private:
  using Clock = std::chrono::steady_clock;

  // Of one learner: of another one when that has been silent for a while.
  void on_status(const ros::MessageEvent<threelink_msgs::TrainingStatus const>& event) {
    constexpr std::chrono::seconds kSilence(10);
    const threelink_msgs::TrainingStatus& status = *event.getConstMessage();
    if (status.updates == 0 || status.update > status.updates) return;  // no learner says that
    if (!status_ || Clock::now() - heard_ > kSilence) learner_.expect("");
    if (!learner_.may_be(event.getPublisherName())) return;
    learner_.is(event.getPublisherName());
    status_ = status;
    heard_ = Clock::now();
  }

  bool finished() const { return status_ && status_->update == status_->updates; }

  void show() {
    if (!finished() && subscriber_.getNumPublishers() == 0) status_.reset();
    if (!status_) {
      show_waiting();
      return;
    }
    waiting_ = false;
    const double age = std::chrono::duration<double>(Clock::now() - heard_).count();
    if (screen_.terminal()) {
      screen_.show(status_screen(*status_, age, terminal_size()));
    } else {
      screen_.show({status_line(*status_, age)});
    }
  }

  void show_waiting() {
    if (!waiting_)
      screen_.show({fmt::format("no training says anything on {}; waiting for one",
                                subscriber_.getTopic())});
    waiting_ = true;
  }

  ros::NodeHandle node_;
  ros::Subscriber subscriber_;
  threelink_sim::Peer learner_;
  std::optional<threelink_msgs::TrainingStatus> status_;
  Clock::time_point heard_;
  Screen screen_;
  bool waiting_ = false;
};

}  // namespace
}  // namespace threelink_agent

int main(int argc, char** argv) {
  CLI::App app;
  std::string name_space = "threelink";
  app.description(
      "Shows how a training goes: progress and time left, steps/s, return, success, and for each\n"
      "worker its host, episodes, how long ago it was heard, leases lost and batches refused.\n"
      "On a terminal the view is redrawn in place, elsewhere it is a line a second. It ends when\n"
      "the training has finished; before there is one, or between two, it waits.");
  app.add_option("--namespace", name_space, "of the training's topics (default threelink)");
  app.footer(
      "Exit status: 0 the training has finished, or SIGINT or SIGTERM; 2 wrong arguments;\n"
      "75 master lost.");
  // ROS takes what is its own, such as __name:=NAME.
  ros::V_string own;
  ros::removeROSArgs(argc, argv, own);
  std::vector<std::string> arguments(own.rbegin(), own.rend() - 1);  // as CLI11 wants them
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? threelink_sim::kSuccess : threelink_sim::kBadInput;
  }
  std::string remapped = "__ns:=" + name_space;
  std::vector<char*> given{argv[0], remapped.data()};
  for (int i = 1; i < argc; ++i)
    if (std::string(argv[i]).find(":=") != std::string::npos) given.push_back(argv[i]);
  threelink_sim::NodeDescription node{"status", "", true};
  return threelink_sim::run_node(static_cast<int>(given.size()), given.data(), node,
                                 [] { return threelink_agent::View().run(); });
}
