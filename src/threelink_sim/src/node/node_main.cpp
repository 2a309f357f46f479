#include "threelink_sim/node/node_main.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <iostream>
#include <optional>
#include <thread>

#include <ros/callback_queue.h>
#include <ros/ros.h>

#include "threelink_sim/mutex.hpp"
#include "threelink_sim/node/peer_types.hpp"

namespace threelink_sim {
namespace {

using namespace std::chrono_literals;

std::atomic<bool> stop_requested{false};
static_assert(std::atomic<bool>::is_always_lock_free, "a signal handler writes it");

void on_signal(int) { stop_requested = true; }

bool master_answers_within(std::chrono::milliseconds patience) {
  const auto deadline = std::chrono::steady_clock::now() + patience;
  while (!ros::master::check()) {
    if (stop_requested || std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(100ms);
  }
  return true;
}

// Asks the master once a second whether it knows this node. A master that was restarted answers,
// but has forgotten all registrations, and roscpp does not renew them.
class MasterWatch {
 public:
  explicit MasterWatch(double patience) : patience_(patience), thread_([this] { watch(); }) {}
  ~MasterWatch() {
    {
      Lock lock(mutex_);
      ending_ = true;
    }
    wake_.notify_one();
    thread_.join();
  }
  bool lost() const { return lost_; }

 private:
  static bool registered() {
    XmlRpc::XmlRpcValue request, response, payload;
    request[0] = ros::this_node::getName();
    request[1] = ros::this_node::getName();
    return ros::master::execute("lookupNode", request, response, payload, false);
  }

  void end_in_time() {
    const auto now = std::chrono::steady_clock::now();
    if (!stopped_) stopped_ = now;
    if (now - *stopped_ >= std::chrono::duration<double>(patience_)) std::_Exit(kSuccess);
  }

  void watch() {
    constexpr int kPatience = 3;
    int failures = 0;
    const auto ending = [this]() REQUIRES(mutex_) { return ending_; };
    Lock lock(mutex_);
    while (!wake_.wait_for(lock, 1s, ending)) {
      if (stop_requested && patience_ > 0 && !lost_) end_in_time();
      failures = registered() ? 0 : failures + 1;
      if (failures == kPatience && running()) {
        lost_ = true;
        stop_requested = true;
        ros::requestShutdown();  // calls to the master that wait for its return give up
        // Not by the log: that reads a parameter, and so waits for ever if the main thread is about
        // to set one, which waits for the master.
        std::cerr << ros::this_node::getName() << ": the ROS master at " << ros::master::getURI()
                  << " is gone, or was restarted; this node ends\n";
      }
    }
  }

  double patience_;  // [s]
  std::optional<std::chrono::steady_clock::time_point> stopped_;
  std::atomic<bool> lost_{false};
  Mutex mutex_;
  std::condition_variable_any wake_;
  bool ending_ GUARDED_BY(mutex_) = false;
  std::thread thread_;  // last: it uses the others
};

int run_body(const std::function<int()>& body) {
  try {
    return body();
  } catch (const UsageError& error) {
    ROS_FATAL("%s", error.what());
    return kBadInput;
  } catch (const std::exception& error) {
    ROS_FATAL("%s", error.what());
    return kFailure;
  }
}

int start_and_run(int argc, char** argv, const NodeDescription& description,
                  const std::function<int()>& body) {
  const uint32_t naming = description.anonymous ? ros::init_options::AnonymousName : 0;
  ros::init(argc, argv, description.name, ros::init_options::NoSigintHandler | naming);
  if (argc > 1) throw UsageError(std::string("unknown argument `") + argv[1] + "`; see --help");
  std::signal(SIGINT, on_signal);
  std::signal(SIGTERM, on_signal);
  if (!master_answers_within(5s)) {
    if (stop_requested) return kSuccess;
    std::cerr << description.name
              << ": no ROS master answers at ROS_MASTER_URI=" << ros::master::getURI()
              << "; start roscore, or use roslaunch\n";
    return kMasterLost;
  }
  int status = kSuccess;
  {
    MasterWatch watch(
        description
            .patience);  // first: ros::start() waits for a master that goes away, without end
    ros::start();
    const PeerTypes peer_types;
    if (running()) status = run_body(body);
    if (watch.lost()) {
      status = kMasterLost;
    } else if (!stop_requested && !ros::ok()) {
      std::cerr << description.name  // the log has been shut down, too
                << ": shut down from outside (rosnode kill, or another node that took the name "
                << ros::this_node::getName() << "); its work was left where it was\n";
      status = kShutDown;
    }
  }
  ros::shutdown();
  return status;
}

}  // namespace

int run_node(int argc, char** argv, const NodeDescription& description,
             const std::function<int()>& body) {
  for (int i = 1; i < argc; ++i) {
    if (argv[i] == std::string("--help") || argv[i] == std::string("-h")) {
      std::cout << description.help;
      return kSuccess;
    }
  }
  try {
    return start_and_run(argc, argv, description, body);
  } catch (const UsageError& error) {
    std::cerr << description.name << ": " << error.what() << '\n';
    return kBadInput;
  } catch (const ros::Exception& error) {  // a bad name or remapping
    std::cerr << description.name << ": " << error.what() << '\n';
    return kBadInput;
  }
}

bool running() { return !stop_requested && ros::ok(); }

int spin() {
  while (running()) ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(0.1));
  return kSuccess;
}

}  // namespace threelink_sim
