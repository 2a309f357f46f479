/// @file
/// Proximal policy optimisation of the swimmer's policy.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <stdexcept>
#include <string>

#include "threelink_agent/evaluate.hpp"
#include "threelink_agent/policy.hpp"
#include "threelink_agent/training/advantage.hpp"
#include "threelink_agent/training/learner_state.hpp"
#include "threelink_agent/training/ppo_update.hpp"
#include "threelink_agent/training/rollout_source.hpp"
#include "threelink_agent/training/train_config.hpp"
#include "threelink_agent/training/update.hpp"

namespace threelink_agent {

/// Error for a training that cannot continue. what() gives the reason.
class TrainingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Number of consecutive non-finite updates that end a training; see Trainer::update().
constexpr std::uint32_t kMostPoisonedInARow = 5;

/// Report of one update.
struct UpdateReport {
  std::uint32_t update = 0;    ///< updates done
  std::uint32_t episodes = 0;  ///< episodes done
  std::uint64_t steps = 0;     ///< environment steps done
  double mean_return = 0;      ///< mean over the update's episodes, with exploration noise
  UpdateStatistics statistics;
  double entropy = 0;  ///< entropy of the policy that played the episodes, summed over hinges
  double std = 0;      ///< [1/T0] standard deviation of its noise, mean over hinges
  LearningRates rates;
  /// Evaluation of the mean action after the update, if one was due. It has no random starts
  /// (trials = 0) if the straight ones showed that this is not the best policy.
  std::optional<Evaluation> evaluation;
  std::string poison;          ///< quantity that was not finite in this update; empty if all were
  std::uint32_t poisoned = 0;  ///< updates discarded so far
};

/// The best policy so far, with its score.
struct BestPolicy {
  Policy policy;
  double score;
};

/// Everything beside the configuration that determines the rest of a training. Random numbers are
/// keyed by (seed, use, episode or update, step), so that there is no generator state.
struct TrainerState {
  std::uint32_t update = 0;  ///< updates done
  LearnerState learner;
  std::optional<BestPolicy> best;
  std::uint32_t poisoned = 0;           ///< updates discarded
  std::uint32_t poisoned_in_a_row = 0;  ///< consecutive ones at the end
};

/// A training, one update at a time:
///
///   Trainer trainer(config, make_ppo_update(backend, config, threads),
///                   std::make_unique<LocalRollouts>(threads));
///   while (!trainer.finished()) report(trainer.update());
///   trainer.best()->save(...);
///
/// The result depends only on the configuration (seed included), not on the number of threads.
class Trainer {
 public:
  /// Throws ConfigError. `ppo` must have been made for the same configuration.
  Trainer(const TrainConfig& config, std::unique_ptr<PpoUpdate> ppo,
          std::unique_ptr<RolloutSource> source = std::make_unique<LocalRollouts>(1));

  /// Continues from a state() of the same configuration, with the same bits.
  Trainer(const TrainConfig& config, std::unique_ptr<PpoUpdate> ppo,
          std::unique_ptr<RolloutSource> source, TrainerState state);

  const TrainConfig& config() const { return config_; }
  bool finished() const { return state_.update == config_.updates(); }

  /// Plays the next episodes, updates the networks, and evaluates the policy if this is due or the
  /// last update.
  ///
  /// If a number of the rollout, the advantages, the losses or the new parameters is not finite,
  /// the networks and their optimisers keep their state, and the report names the quantity;
  /// kMostPoisonedInARow consecutive updates of this kind throw TrainingError. If the source of
  /// rollouts throws, the state does not change.
  UpdateReport update();

  /// The current policy.
  Policy policy() const;
  /// The policy with the best evaluation so far; null before the first evaluation. If the goal has
  /// a target, it is the last evaluated policy: an evaluation of affordable length measures the
  /// ability to reach points mostly by chance, and the learning rates fall to 0 towards the end.
  const Policy* best() const { return state_.best ? &state_.best->policy : nullptr; }

  const TrainerState& state() const { return state_; }

 private:
  Rollout play_or_restore(const Play& play, int episodes);
  Advantages advantages(const Rollout& rollout) const;
  /// Updates the networks, and state_.learner if all numbers are finite; otherwise returns the name
  /// of the quantity that is not.
  std::string learn(const Rollout& rollout, const LearningRates& rates,
                    UpdateStatistics& statistics);
  /// Evaluates the current policy and keeps it if it is the best.
  Evaluation evaluate_present();

  TrainConfig config_;
  std::unique_ptr<PpoUpdate> ppo_;
  std::unique_ptr<RolloutSource> source_;
  TrainerState state_;
};

/// The quantity that training maximises, per unit of time and divided by b: v - c P / b [L/T0],
/// with v [L/T0] the speed and P [C_perp L^3/T0^2] the mean power of the steady stroke, averaged
/// over the straight starts.
double objective(const Evaluation& evaluation, const threelink_sim::EnvironmentConfig& environment);
/// The rank of a policy: objective() times the success rate from the random starts, where a policy
/// can be stuck.
double score(const Evaluation& evaluation, const threelink_sim::EnvironmentConfig& environment);

/// The metadata of a policy of this training, its configuration included.
PolicyMetadata policy_metadata(const TrainConfig& config);

}  // namespace threelink_agent
