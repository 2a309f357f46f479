// Proximal policy optimisation of the swimmer's policy.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include "threelink_agent/evaluate.hpp"
#include "threelink_agent/policy.hpp"
#include "threelink_agent/training/advantage.hpp"
#include "threelink_agent/training/rollout.hpp"
#include "threelink_agent/training/train_config.hpp"
#include "threelink_agent/training/update.hpp"

namespace threelink_agent {

class PpoUpdate;

// What one update did.
struct UpdateReport {
  std::uint32_t update;    // updates done
  std::uint32_t episodes;  // episodes done
  std::uint64_t steps;     // environment steps done
  double mean_return;      // of the update's episodes, with exploration noise
  UpdateStatistics statistics;
  double entropy;  // of the policy that played the episodes, summed over hinges
  double std;      // [1/T0] of its noise, mean over hinges
  LearningRates rates;
  std::optional<Evaluation> evaluation;  // of the mean action after the update, when it was due
};

// The training, one update at a time:
//
//   Trainer trainer(config, threads);
//   while (!trainer.finished()) report(trainer.update());
//   trainer.best()->save(...);
//
// The result depends on the configuration alone (seed included), not on the number of threads.
class Trainer {
 public:
  // Throws ConfigError. threads: at least 1; the update uses at most two. Sets BLAS and LibTorch,
  // in the whole process, to one thread for each operation.
  Trainer(const TrainConfig& config, int threads);
  ~Trainer();

  const TrainConfig& config() const { return config_; }
  bool finished() const { return update_ == config_.updates(); }

  // Rolls out the next episodes, updates the networks, evaluates if it is due or the last.
  UpdateReport update();

  // The present policy.
  Policy policy() const;
  // The one that evaluated best so far; none before the first evaluation.
  const std::optional<Policy>& best() const { return best_; }

 private:
  Advantages advantages(const Rollout& rollout) const;
  // Of the present policy, which becomes the best one if it is.
  Evaluation evaluate_present();

  TrainConfig config_;
  std::unique_ptr<PpoUpdate> ppo_;
  std::uint32_t update_ = 0;
  std::uint32_t episodes_ = 0;
  std::optional<Policy> best_;
  double best_score_ = 0;
};

// How policies are ranked: what training maximises, per unit of time and over b, v - c P / b with v
// [L/T0] the speed and P [C_perp L^3/T0^2] the mean power of the steady stroke, averaged over the
// straight starts; times the rate of success from the random ones, where a policy can be stuck.
double score(const Evaluation& evaluation, const threelink_sim::EnvironmentConfig& environment);

}  // namespace threelink_agent
