// Plays an episode of a task in this process, for comparison with one over topics:
//   play_episode POLICY SEED EPISODE TASK PARAMETERS mean|sampled [WORLD]
// PARAMETERS is a YAML map, WORLD the path of a file. One line for each state k: x y heading
// alpha_1 alpha_2 target_x target_y [rate_1 rate_2], in the notation of %a, which gives every bit.
#include <cstdio>
#include <cstdlib>
#include <string>

#include "threelink_agent/evaluate.hpp"
#include "threelink_sim/plugins.hpp"
#include "threelink_tasks/episode.hpp"
#include "threelink_tasks/task_factory.hpp"

int main(int argc, char** argv) {
  if (argc != 7 && argc != 8) return 2;
  threelink_sim::load_plugins();
  const auto policy = threelink_agent::Policy::load(argv[1]);
  threelink_sim::ParameterMap parameters("parameters", YAML::Load(argv[5]));
  const double v_m = threelink_agent::evaluate(policy, 0, 0).speed;
  const auto task = threelink_tasks::make_task(argv[4], parameters, {0.1, v_m});
  threelink_sim::EnvironmentConfig config = policy.metadata().environment();
  if (argc == 8) config.world = threelink_sim::World::load(argv[7]);
  threelink_sim::Environment environment(config, 1);
  const auto print = [](const threelink_tasks::EpisodeStep& step) {
    std::printf("%a %a %a", step.state.centroid.x(), step.state.centroid.y(), step.state.heading);
    const auto print_each = [](const threelink_sim::HingeVector& values) {
      for (Eigen::Index i = 0; i < values.size(); ++i) std::printf(" %a", values[i]);
    };
    print_each(step.state.alpha);
    std::printf(" %a %a", step.target.x(), step.target.y());
    print_each(step.rates);
    std::printf("\n");
  };
  threelink_tasks::run_episode(*task, environment, policy, std::strtoull(argv[2], nullptr, 10),
                               static_cast<std::uint32_t>(std::atol(argv[3])),
                               argv[6] == std::string("sampled"), print);
  return 0;
}
