#include "policy_file.hpp"

#include <fmt/format.h>

#include "threelink_agent/container_fields.hpp"
#include "threelink_sim/excerpt.hpp"

namespace threelink_agent {
namespace {

constexpr char kFormat[] = "threelink-policy-1";
constexpr char kActor[] = "actor";
constexpr char kLogStd[] = "log_std";

bool sampled_from_string(const std::string& name) {
  if (name != "mean" && name != "sampled")
    throw std::invalid_argument(fmt::format("actions \"{}\": must be \"mean\" or \"sampled\"",
                                            threelink_sim::excerpt(name)));
  return name == "sampled";
}

PolicyMetadata metadata_of(ContainerReader& reader) {
  if (reader.text("format") != kFormat)
    throw PolicyError(fmt::format("format \"{}\": must be \"{}\"",
                                  threelink_sim::excerpt(reader.text("format")), kFormat));
  PolicyMetadata metadata;
  metadata.action = reader.text("action");
  metadata.links = static_cast<int>(reader.count("links", 1'000'000));
  metadata.dt = reader.number("dt");
  metadata.gamma = reader.number("gamma");
  metadata.config = reader.text("config");
  try {
    metadata.observation = threelink_sim::observation_kind_from_string(reader.text("observation"));
    // The keys that may be absent: most programs know no symmetries, play the mean, and leave the
    // joint limit as it is.
    if (reader.has_field("joint_limit")) metadata.joint_limit = reader.number("joint_limit");
    if (reader.has_field("symmetry"))
      metadata.symmetry = symmetry_from_string(reader.text("symmetry"));
    if (reader.has_field("actions")) metadata.sampled = sampled_from_string(reader.text("actions"));
    metadata.validate();
  } catch (const std::invalid_argument& error) {
    throw PolicyError(error.what());
  }
  return metadata;
}

// The outputs of a layer before the last one are free.
Eigen::Index hidden_outputs(const ContainerReader& reader, std::size_t l) {
  const std::string name = weight_name(kActor, l);
  const TensorShape& shape = reader.shape(name);
  const std::size_t outputs = shape.empty() ? 0 : shape.front();
  if (outputs < 1 || outputs > Mlp::kMaxWidth)
    throw PolicyError(fmt::format("{} has shape {}, expected 1 to {} rows", name, to_string(shape),
                                  Mlp::kMaxWidth));
  return static_cast<Eigen::Index>(outputs);
}

std::vector<Linear> layers_of(ContainerReader& reader, Eigen::Index inputs, Eigen::Index outputs) {
  std::vector<Linear> layers;
  bool last = false;
  while (!last) {
    const std::size_t l = layers.size();
    last = !reader.has_tensor(weight_name(kActor, l + 1));
    const Eigen::Index rows = last ? outputs : hidden_outputs(reader, l);
    layers.push_back(reader.layer(kActor, l, rows, inputs));
    inputs = rows;
  }
  return layers;
}

}  // namespace

Container to_container(const PolicyParts& parts) {
  const PolicyMetadata& metadata = parts.metadata;
  Container container;
  container.metadata = {{"format", kFormat},
                        {"observation", to_string(metadata.observation)},
                        {"action", metadata.action},
                        {"links", number_text(static_cast<std::uint64_t>(metadata.links))},
                        {"dt", number_text(metadata.dt)},
                        {"gamma", number_text(metadata.gamma)},
                        {"symmetry", to_string(metadata.symmetry)},
                        {"config", metadata.config}};
  if (metadata.sampled) container.metadata["actions"] = "sampled";
  if (metadata.joint_limit != PolicyMetadata().joint_limit)
    container.metadata["joint_limit"] = number_text(metadata.joint_limit);
  put_layers(container, kActor, parts.layers);
  put_vector(container, kLogStd, parts.log_std);
  return container;
}

PolicyParts from_container(const Container& container) {
  ContainerReader reader(container, kMaxParameter);
  PolicyParts parts;
  parts.metadata = metadata_of(reader);
  const int hinges = parts.metadata.links - 1;
  parts.layers = layers_of(reader, parts.metadata.observation_size(), hinges);
  parts.log_std = reader.vector(kLogStd, hinges);
  reader.finish();
  return parts;
}

}  // namespace threelink_agent
