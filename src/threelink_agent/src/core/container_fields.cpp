#include "threelink_agent/container_fields.hpp"

#include <cmath>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "threelink_sim/excerpt.hpp"

namespace threelink_agent {

using nlohmann::json;
using threelink_sim::excerpt;

namespace {

std::size_t size_of(Eigen::Index n) { return static_cast<std::size_t>(n); }

// A number as JSON writes it; null if it is none.
json number_of(const std::string& text) {
  constexpr std::size_t kMostBytes = 64;
  if (text.size() > kMostBytes) return {};
  const json number = json::parse(text, nullptr, false);
  return number.is_number() ? number : json();
}

}  // namespace

std::string number_text(double value) { return json(value).dump(); }
std::string number_text(std::uint64_t value) { return json(value).dump(); }

std::string weight_name(const std::string& prefix, std::size_t layer) {
  return fmt::format("{}.{}.weight", prefix, 2 * layer);
}
std::string bias_name(const std::string& prefix, std::size_t layer) {
  return fmt::format("{}.{}.bias", prefix, 2 * layer);
}

void put_vector(Container& container, const std::string& name, const Eigen::VectorXf& values) {
  container.tensors[name] = Tensor::of({size_of(values.size())}, values.data());
}

void put_layers(Container& container, const std::string& prefix,
                const std::vector<Linear>& layers) {
  for (std::size_t l = 0; l < layers.size(); ++l) {
    const auto& [weight, bias] = layers[l];
    container.tensors[weight_name(prefix, l)] =
        Tensor::of({size_of(weight.rows()), size_of(weight.cols())}, weight.data());
    put_vector(container, bias_name(prefix, l), bias);
  }
}

const std::string& ContainerReader::text(const std::string& key) {
  const auto found = container_.metadata.find(key);
  if (found == container_.metadata.end())
    throw ContainerError(fmt::format("metadata \"{}\" is missing", key));
  keys_.insert(key);
  return found->second;
}

double ContainerReader::number(const std::string& key) {
  const std::string& written = text(key);
  const json number = number_of(written);
  if (!number.is_number() || !std::isfinite(number.get<double>()))
    throw ContainerError(
        fmt::format("metadata \"{}\" is \"{}\", not a number", key, excerpt(written)));
  return number.get<double>();
}

std::uint64_t ContainerReader::count(const std::string& key, std::uint64_t most) {
  const std::string& written = text(key);
  const json number = number_of(written);
  if (!number.is_number())
    throw ContainerError(
        fmt::format("metadata \"{}\" is \"{}\", not a number", key, excerpt(written)));
  if (!number.is_number_unsigned() || number.get<std::uint64_t>() > most)
    throw ContainerError(
        fmt::format("metadata \"{}\" is {}, not a whole number in [0, {}]", key, written, most));
  return number.get<std::uint64_t>();
}

const TensorShape& ContainerReader::shape(const std::string& name) const {
  const auto found = container_.tensors.find(name);
  if (found == container_.tensors.end()) throw ContainerError(name + " is missing");
  return found->second.shape;
}

std::vector<float> ContainerReader::values(const std::string& name, const TensorShape& expected) {
  if (shape(name) != expected)
    throw ContainerError(fmt::format("{} has shape {}, expected {}", name, to_string(shape(name)),
                                     to_string(expected)));
  names_.insert(name);
  std::vector<float> values;
  try {
    values = container_.tensors.at(name).values<float>();
  } catch (const ContainerError& error) {
    throw ContainerError(fmt::format("{}: {}", name, error.what()));
  }
  for (float value : values)
    if (!(std::abs(value) <= most_))
      throw ContainerError(fmt::format("{} has the value {}, not within +-{}", name, value, most_));
  return values;
}

Eigen::VectorXf ContainerReader::vector(const std::string& name, Eigen::Index size) {
  const std::vector<float> numbers = values(name, {size_of(size)});
  return Eigen::Map<const Eigen::VectorXf>(numbers.data(), size);
}

Linear ContainerReader::layer(const std::string& prefix, std::size_t layer, Eigen::Index outputs,
                              Eigen::Index inputs) {
  const std::vector<float> weight =
      values(weight_name(prefix, layer), {size_of(outputs), size_of(inputs)});
  return {Eigen::Map<const decltype(Linear::weight)>(weight.data(), outputs, inputs),
          vector(bias_name(prefix, layer), outputs)};
}

std::vector<Linear> ContainerReader::layers(const std::string& prefix, std::vector<Linear> layers) {
  for (std::size_t l = 0; l < layers.size(); ++l)
    layers[l] = layer(prefix, l, layers[l].weight.rows(), layers[l].weight.cols());
  return layers;
}

void ContainerReader::finish() const {
  for (const auto& item : container_.metadata)
    if (!keys_.count(item.first))
      throw ContainerError(fmt::format("metadata \"{}\" is not known", excerpt(item.first)));
  for (const auto& [name, tensor] : container_.tensors)
    if (!names_.count(name))
      throw ContainerError(
          fmt::format("{} of shape {} is not known", excerpt(name), to_string(tensor.shape)));
}

}  // namespace threelink_agent
