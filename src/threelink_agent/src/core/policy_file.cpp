#include "policy_file.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace threelink_agent {
namespace {

using nlohmann::json;

constexpr char kFormat[] = "threelink-policy-1";
constexpr char kLogStd[] = "log_std";

// Names as PyTorch gives them to the layers of a Sequential with a tanh after each but the last.
std::string weight_name(std::size_t layer) { return fmt::format("actor.{}.weight", 2 * layer); }
std::string bias_name(std::size_t layer) { return fmt::format("actor.{}.bias", 2 * layer); }

// A number as text that reads back to the same bits, whatever the locale.
template <class Number>
std::string to_text(Number value) {
  return json(value).dump();
}

using Texts = std::map<std::string, std::string>;

const std::string& text_of(const Texts& metadata, const char* key) {
  const auto found = metadata.find(key);
  if (found == metadata.end()) throw PolicyError(fmt::format("metadata \"{}\" is missing", key));
  return found->second;
}

double number_of(const Texts& metadata, const char* key) {
  const std::string& text = text_of(metadata, key);
  const json number = json::parse(text, nullptr, false);
  if (!number.is_number())
    throw PolicyError(fmt::format("metadata \"{}\" is \"{}\", not a number", key, text));
  return number.get<double>();
}

int integer_of(const Texts& metadata, const char* key) {
  const double number = number_of(metadata, key);
  if (!(number == std::floor(number) && std::abs(number) < 1e9))
    throw PolicyError(fmt::format("metadata \"{}\" is {}, not a whole number", key, number));
  return static_cast<int>(number);
}

PolicyMetadata metadata_of(const Texts& texts) {
  const char* const known[] = {"format", "observation", "action",   "links",
                               "dt",     "gamma",       "symmetry", "config"};
  for (const auto& item : texts)
    if (std::find(std::begin(known), std::end(known), item.first) == std::end(known))
      throw PolicyError(fmt::format("metadata \"{}\" is not known", item.first));
  if (text_of(texts, "format") != kFormat)
    throw PolicyError(
        fmt::format("format \"{}\": must be \"{}\"", text_of(texts, "format"), kFormat));
  PolicyMetadata metadata;
  metadata.observation = text_of(texts, "observation");
  metadata.action = text_of(texts, "action");
  metadata.links = integer_of(texts, "links");
  metadata.dt = number_of(texts, "dt");
  metadata.gamma = number_of(texts, "gamma");
  metadata.config = text_of(texts, "config");
  try {
    // The one key that may be absent: most programs know no symmetries.
    if (texts.count("symmetry")) metadata.symmetry = symmetry_from_string(texts.at("symmetry"));
    metadata.validate();
  } catch (const std::invalid_argument& error) {
    throw PolicyError(error.what());
  }
  return metadata;
}

using Tensors = std::map<std::string, Tensor>;

const Tensor& tensor_of(const Tensors& tensors, const std::string& name) {
  const auto found = tensors.find(name);
  if (found == tensors.end()) throw PolicyError(name + " is missing");
  return found->second;
}

// The values of a tensor after all checks.
std::vector<float> values_of(const Tensors& tensors, const std::string& name,
                             const TensorShape& expected) {
  const Tensor& tensor = tensor_of(tensors, name);
  if (tensor.shape != expected)
    throw PolicyError(fmt::format("{} has shape {}, expected {}", name, to_string(tensor.shape),
                                  to_string(expected)));
  std::vector<float> values;
  try {
    values = tensor.values<float>();
  } catch (const ContainerError& error) {
    throw PolicyError(fmt::format("{}: {}", name, error.what()));
  }
  for (float value : values)
    if (!(std::abs(value) <= kMaxParameter))
      throw PolicyError(
          fmt::format("{} has the value {}, not within +-{}", name, value, kMaxParameter));
  return values;
}

// The outputs of a layer before the last one are free; the shape is checked by values_of().
std::size_t hidden_outputs(const Tensors& tensors, std::size_t l) {
  const TensorShape& shape = tensor_of(tensors, weight_name(l)).shape;
  const std::size_t outputs = shape.empty() ? 0 : shape.front();
  if (outputs < 1 || outputs > Mlp::kMaxWidth)
    throw PolicyError(fmt::format("{} has shape {}, expected 1 to {} rows", weight_name(l),
                                  to_string(shape), Mlp::kMaxWidth));
  return outputs;
}

std::vector<Linear> layers_of(const Tensors& tensors, std::size_t inputs, std::size_t outputs) {
  std::vector<Linear> layers;
  bool last = false;
  while (!last) {
    const std::size_t l = layers.size();
    last = !tensors.count(weight_name(l + 1));
    const std::size_t rows = last ? outputs : hidden_outputs(tensors, l);
    const std::vector<float> weight = values_of(tensors, weight_name(l), {rows, inputs});
    const std::vector<float> bias = values_of(tensors, bias_name(l), {rows});
    layers.push_back({Eigen::Map<const decltype(Linear::weight)>(weight.data(), rows, inputs),
                      Eigen::Map<const Eigen::VectorXf>(bias.data(), rows)});
    inputs = rows;
  }
  return layers;
}

}  // namespace

Container to_container(const PolicyParts& parts) {
  const PolicyMetadata& metadata = parts.metadata;
  Container container;
  container.metadata = {{"format", kFormat},
                        {"observation", metadata.observation},
                        {"action", metadata.action},
                        {"links", to_text(metadata.links)},
                        {"dt", to_text(metadata.dt)},
                        {"gamma", to_text(metadata.gamma)},
                        {"symmetry", to_string(metadata.symmetry)},
                        {"config", metadata.config}};
  const auto size = [](Eigen::Index n) { return static_cast<std::size_t>(n); };
  for (std::size_t l = 0; l < parts.layers.size(); ++l) {
    const auto& [weight, bias] = parts.layers[l];
    container.tensors[weight_name(l)] =
        Tensor::of({size(weight.rows()), size(weight.cols())}, weight.data());
    container.tensors[bias_name(l)] = Tensor::of({size(bias.size())}, bias.data());
  }
  container.tensors[kLogStd] = Tensor::of({size(parts.log_std.size())}, parts.log_std.data());
  return container;
}

PolicyParts from_container(const Container& container) {
  PolicyParts parts;
  parts.metadata = metadata_of(container.metadata);
  const auto inputs = static_cast<std::size_t>(parts.metadata.observation_size());
  const auto hinges = static_cast<std::size_t>(parts.metadata.links - 1);
  parts.layers = layers_of(container.tensors, inputs, hinges);
  const std::vector<float> log_std = values_of(container.tensors, kLogStd, {hinges});
  parts.log_std = Eigen::Map<const Eigen::VectorXf>(log_std.data(), log_std.size());

  const std::size_t expected = 2 * parts.layers.size() + 1;
  if (container.tensors.size() != expected) {
    for (const auto& [name, tensor] : container.tensors) {
      bool known = name == kLogStd;
      for (std::size_t l = 0; l < parts.layers.size(); ++l)
        known = known || name == weight_name(l) || name == bias_name(l);
      if (!known)
        throw PolicyError(
            fmt::format("{} of shape {} is not known", name, to_string(tensor.shape)));
    }
  }
  return parts;
}

}  // namespace threelink_agent
