// Plays an episode of the pursuit in this process, for comparison with one over topics:
//   play_episode POLICY SEED EPISODE V_RATIO
// One line for each state k: x y heading alpha_1 alpha_2 target_x target_y [rate_1 rate_2], in the
// notation of %a, which gives every bit.
#include <cstdio>
#include <cstdlib>

#include "threelink_agent/evaluate.hpp"
#include "threelink_tasks/episode.hpp"
#include "threelink_tasks/pursuit.hpp"

int main(int argc, char** argv) {
  if (argc != 5) return 2;
  const auto policy = threelink_agent::Policy::load(argv[1]);
  threelink_tasks::PursuitParameters parameters;
  parameters.speed = std::atof(argv[4]) * threelink_agent::evaluate(policy, 0, 0).speed;
  threelink_tasks::Pursuit task(parameters);
  threelink_sim::Environment environment(threelink_sim::EnvironmentConfig(), 1);
  const auto print = [](const threelink_tasks::EpisodeStep& step) {
    std::printf("%a %a %a", step.state.centroid.x(), step.state.centroid.y(), step.state.heading);
    for (const double alpha : step.state.alpha) std::printf(" %a", alpha);
    std::printf(" %a %a", step.target.x(), step.target.y());
    for (const double rate : step.rates) std::printf(" %a", rate);
    std::printf("\n");
  };
  threelink_tasks::run_episode(task, environment, policy, std::strtoull(argv[2], nullptr, 10),
                               static_cast<std::uint32_t>(std::atol(argv[3])), print);
  return 0;
}
