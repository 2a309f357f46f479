// clicked_point: where the user points to, again and again. At first that is the start.
//
// The episode ends after `clicks` points have been reached, or never if that is 0.
#include <limits>

#include "builtin_tasks.hpp"
#include "threelink_sim/task/basic_task.hpp"

namespace threelink_sim {
namespace {

constexpr int kMaxInt = std::numeric_limits<int>::max();

class ClickedPointTask : public BasicTask {
 public:
  ClickedPointTask() : BasicTask(kMaxInt) {}

  void configure(ParameterMap& parameters, const TaskContext& context) override {
    BasicTask::configure(parameters, context);
    clicks_ = static_cast<std::uint32_t>(parameters.integer("clicks", {0, kMaxInt}, 0));
    constexpr bool kTargetMoves = false;
    configure_capture(parameters, kTargetMoves);
  }

  bool takes_points() const override { return true; }
  void take_point(const Eigen::Vector2d& point) override {
    target_ = point;
    under_way_ = true;
  }
  std::uint32_t waypoint() const override { return reached_; }

 private:
  void begin() override {
    target_ = start_centroid();
    under_way_ = false;
    reached_ = 0;
  }

  bool advance(std::uint32_t /*step*/, const Eigen::Vector2d& centroid) override {
    if (capture_.captured(centroid, target_) && under_way_) {
      under_way_ = false;
      ++reached_;
    }
    return clicks_ > 0 && reached_ >= clicks_;
  }

  std::uint32_t clicks_ = 0;
  std::uint32_t reached_ = 0;
  bool under_way_ = false;  // to a point not yet reached
};

}  // namespace

std::unique_ptr<Task> make_clicked_point() { return std::make_unique<ClickedPointTask>(); }

}  // namespace threelink_sim
