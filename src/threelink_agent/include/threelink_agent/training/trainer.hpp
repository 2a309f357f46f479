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

/// A training that cannot go on; what() gives the reason.
class TrainingError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// So many updates in a row may be poisoned; see Trainer::update().
constexpr std::uint32_t kMostPoisonedInARow = 5;

/// What one update did.
struct UpdateReport {
  std::uint32_t update = 0;    ///< updates done
  std::uint32_t episodes = 0;  ///< episodes done
  std::uint64_t steps = 0;     ///< environment steps done
  double mean_return = 0;      ///< of the update's episodes, with exploration noise
  UpdateStatistics statistics;
  double entropy = 0;  ///< of the policy that played the episodes, summed over hinges
  double std = 0;      ///< [1/T0] of its noise, mean over hinges
  LearningRates rates;
  /// Of the mean action after the update, when it was due; without random starts (trials = 0) where
  /// the straight ones showed that this is not the best policy.
  std::optional<Evaluation> evaluation;
  std::string poison;          ///< what was not finite in this update; empty if all was well
  std::uint32_t poisoned = 0;  ///< updates so far that were thrown away
};

/// A policy that was kept, with its score.
struct BestPolicy {
  Policy policy;
  double score;
};

/// Everything that the rest of a training depends on, beside its configuration. Random numbers are
/// keyed by (seed, use, episode or update, step), so that there is no state of a generator.
struct TrainerState {
  std::uint32_t update = 0;  ///< updates done
  LearnerState learner;
  std::optional<BestPolicy> best;
  std::uint32_t poisoned = 0;           ///< updates thrown away
  std::uint32_t poisoned_in_a_row = 0;  ///< the last ones of them
};

/// The training, one update at a time:
///
///   Trainer trainer(config, make_ppo_update(backend, config, threads),
///                   std::make_unique<LocalRollouts>(threads));
///   while (!trainer.finished()) report(trainer.update());
///   trainer.best()->save(...);
///
/// The result depends on the configuration alone (seed included), not on the number of threads.
class Trainer {
 public:
  /// Throws ConfigError. `ppo` was made for the same configuration.
  Trainer(const TrainConfig& config, std::unique_ptr<PpoUpdate> ppo,
          std::unique_ptr<RolloutSource> source = std::make_unique<LocalRollouts>(1));

  /// Goes on from a state() of the same configuration, to the same bits.
  Trainer(const TrainConfig& config, std::unique_ptr<PpoUpdate> ppo,
          std::unique_ptr<RolloutSource> source, TrainerState state);

  const TrainConfig& config() const { return config_; }
  bool finished() const { return state_.update == config_.updates(); }

  /// Rolls out the next episodes, updates the networks, evaluates if it is due or the last.
  ///
  /// If a number of the rollout, the advantages, the losses or the new parameters is not finite,
  /// the networks and their optimisers stay as they were, and the report says so;
  /// kMostPoisonedInARow such updates throw TrainingError. If the source of rollouts throws, all
  /// stays as it was.
  UpdateReport update();

  /// The present policy.
  Policy policy() const;
  /// The one that evaluated best so far; null before the first evaluation. With a target it
  /// is the last one that was evaluated: what an evaluation of bearable length tells of the way to
  /// points is mostly chance, and towards the end the learning rates fall to nothing.
  const Policy* best() const { return state_.best ? &state_.best->policy : nullptr; }

  const TrainerState& state() const { return state_; }

 private:
  Rollout play_or_restore(const Play& play, int episodes);
  Advantages advantages(const Rollout& rollout) const;
  /// Updates the networks, and state_.learner with them unless something was not finite, which it
  /// returns.
  std::string learn(const Rollout& rollout, const LearningRates& rates,
                    UpdateStatistics& statistics);
  /// Of the present policy, which becomes the best one if it is.
  Evaluation evaluate_present();

  TrainConfig config_;
  std::unique_ptr<PpoUpdate> ppo_;
  std::unique_ptr<RolloutSource> source_;
  TrainerState state_;
};

/// How policies are ranked: what training maximises, per unit of time and over b, v - c P / b with
/// v [L/T0] the speed and P [C_perp L^3/T0^2] the mean power of the steady stroke, averaged over
/// the straight starts ...
double objective(const Evaluation& evaluation, const threelink_sim::EnvironmentConfig& environment);
/// ... times the rate of success from the random ones, where a policy can be stuck.
double score(const Evaluation& evaluation, const threelink_sim::EnvironmentConfig& environment);

/// The metadata of a policy of this training, its configuration included.
PolicyMetadata policy_metadata(const TrainConfig& config);

}  // namespace threelink_agent
