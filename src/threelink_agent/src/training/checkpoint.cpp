#include "threelink_agent/training/checkpoint.hpp"

#include <algorithm>
#include <limits>
#include <utility>

#include <fmt/format.h>

#include "threelink_agent/container_fields.hpp"
#include "threelink_sim/excerpt.hpp"

namespace threelink_agent {
namespace {

constexpr char kFormat[] = "threelink-checkpoint-1";
constexpr char kMean[] = "adam.mean.", kVariance[] = "adam.variance.", kBest[] = "best.";
constexpr std::uint64_t kMostMetricsBytes = std::uint64_t{1} << 40;
constexpr double kMostSeconds = 1e10;  // [s] 300 years

void put(Container& container, const std::string& prefix, const LearnerTensors& tensors) {
  put_layers(container, prefix + "actor", tensors.actor);
  put_vector(container, prefix + "log_std", tensors.log_std);
  put_layers(container, prefix + "critic", tensors.critic);
}

// Of the shapes that `like` has.
LearnerTensors read(ContainerReader& reader, const std::string& prefix,
                    const LearnerTensors& like) {
  return {reader.layers(prefix + "actor", like.actor),
          reader.vector(prefix + "log_std", like.log_std.size()),
          reader.layers(prefix + "critic", like.critic)};
}

// Adam divides by its root.
void check_variance(const LearnerTensors& variance) {
  const auto check = [](const auto& values) {
    if (values.size() > 0 && values.minCoeff() < 0)
      throw ContainerError(
          fmt::format("{}.. has the value {}, below 0", kVariance, values.minCoeff()));
  };
  for (const auto* layers : {&variance.actor, &variance.critic})
    for (const Linear& layer : *layers) {
      check(layer.weight);
      check(layer.bias);
    }
  check(variance.log_std);
}

LearnerState read_learner(ContainerReader& reader, const TrainConfig& config) {
  const LearnerTensors like = initial_state(config).parameters;
  LearnerState learner;
  learner.parameters = read(reader, "", like);
  learner.mean = read(reader, kMean, like);
  learner.variance = read(reader, kVariance, like);
  check_variance(learner.variance);
  return learner;
}

std::optional<BestPolicy> read_best(ContainerReader& reader, const TrainConfig& config,
                                    const LearnerTensors& like) {
  if (!reader.has_field("best_score")) return {};
  std::vector<Linear> layers = reader.layers(std::string(kBest) + "actor", like.actor);
  Eigen::VectorXf log_std = reader.vector(std::string(kBest) + "log_std", like.log_std.size());
  return BestPolicy{Policy(policy_metadata(config), Mlp(std::move(layers)), std::move(log_std)),
                    reader.number("best_score")};
}

void check_config(const std::string& yaml, const TrainConfig& config) {
  const TrainConfig own = parse_train_config(yaml, "its configuration");
  if (const auto difference = first_difference(own, config))
    throw ContainerError(fmt::format("{} = {}, but the training has {}", difference->name,
                                     difference->a, difference->b));
}

Checkpoint read(const Container& container, const TrainConfig& config) {
  ContainerReader reader(container, std::numeric_limits<float>::max());
  if (reader.text("format") != kFormat)
    throw ContainerError(fmt::format("format \"{}\": must be \"{}\"",
                                     threelink_sim::excerpt(reader.text("format")), kFormat));
  Checkpoint checkpoint;
  checkpoint.config = config;
  TrainerState& state = checkpoint.state;
  // Before the configurations: a wrong architecture is best told by its shapes.
  state.learner = read_learner(reader, config);
  check_config(reader.text("config"), config);
  checkpoint.backend = reader.text("backend");

  const std::uint64_t updates = config.updates();
  state.update = static_cast<std::uint32_t>(reader.count("update", updates));
  const std::uint64_t samples = std::uint64_t{config.update.episodes} * config.environment.steps;
  const std::uint64_t minibatches =
      (samples + config.update.minibatch - 1) / config.update.minibatch;
  state.learner.adam_steps =
      reader.count("adam_steps", state.update * minibatches * config.update.epochs);
  state.poisoned = static_cast<std::uint32_t>(reader.count("poisoned", state.update));
  state.poisoned_in_a_row =
      static_cast<std::uint32_t>(reader.count("poisoned_in_a_row", state.poisoned));
  state.best = read_best(reader, config, state.learner.parameters);
  checkpoint.metrics_bytes = reader.count("metrics_bytes", kMostMetricsBytes);
  checkpoint.seconds = reader.number("seconds");
  if (!(checkpoint.seconds >= 0 && checkpoint.seconds <= kMostSeconds))
    throw ContainerError(fmt::format("metadata \"seconds\" is {}, not in [0, {}]",
                                     checkpoint.seconds, kMostSeconds));
  reader.finish();
  return checkpoint;
}

}  // namespace

std::string serialize(const Checkpoint& checkpoint) {
  const TrainerState& state = checkpoint.state;
  Container container;
  container.metadata = {{"format", kFormat},
                        {"config", to_yaml(checkpoint.config)},
                        {"backend", checkpoint.backend},
                        {"update", number_text(std::uint64_t{state.update})},
                        {"adam_steps", number_text(state.learner.adam_steps)},
                        {"poisoned", number_text(std::uint64_t{state.poisoned})},
                        {"poisoned_in_a_row", number_text(std::uint64_t{state.poisoned_in_a_row})},
                        {"metrics_bytes", number_text(checkpoint.metrics_bytes)},
                        {"seconds", number_text(checkpoint.seconds)}};
  put(container, "", state.learner.parameters);
  put(container, kMean, state.learner.mean);
  put(container, kVariance, state.learner.variance);
  if (state.best) {
    container.metadata["best_score"] = number_text(state.best->score);
    put_layers(container, std::string(kBest) + "actor", state.best->policy.actor().layers());
    put_vector(container, std::string(kBest) + "log_std", state.best->policy.log_std());
  }
  return serialize(container).bytes;
}

Checkpoint parse_checkpoint(const std::string& bytes, const std::string& source,
                            const TrainConfig& config) {
  const auto refuse = [&](const std::exception& error) {
    return CheckpointError(fmt::format("{}: {}", source, error.what()));
  };
  try {
    std::string data_hash;
    return read(parse_container(bytes, data_hash), config);
  } catch (const ContainerError& error) {
    throw refuse(error);
  } catch (const ConfigError& error) {
    throw refuse(error);
  } catch (const PolicyError& error) {
    throw refuse(error);
  }
}

}  // namespace threelink_agent
