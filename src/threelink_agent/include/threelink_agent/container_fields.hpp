/// @file
/// Metadata fields and layers in containers, as policy files and checkpoints have them.
///
///
/// Numbers are written to the metadata as JSON, so that they are read back to the same bits in any
/// locale. A layer has the name that PyTorch gives to the layer of a Sequential with a tanh after
/// each layer but the last: PREFIX.0.weight, PREFIX.0.bias, PREFIX.2.weight, ...
#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include <Eigen/Core>

#include "threelink_agent/linear.hpp"
#include "threelink_agent/safetensors.hpp"

namespace threelink_agent {

std::string number_text(double value);  ///< finite
/// The number in decimal.
std::string number_text(std::uint64_t value);

/// Name of the weights of layer `layer`, counted from 0: PREFIX.<2 layer>.weight.
std::string weight_name(const std::string& prefix, std::size_t layer);
/// Name of the biases of layer `layer`, counted from 0: PREFIX.<2 layer>.bias.
std::string bias_name(const std::string& prefix, std::size_t layer);

/// Adds weights and biases of all layers to the container.
void put_layers(Container& container, const std::string& prefix, const std::vector<Linear>& layers);
/// Adds a tensor of one dimension to the container.
void put_vector(Container& container, const std::string& name, const Eigen::VectorXf& values);

/// Reads a container entry by entry. Every method throws ContainerError that names the entry, its
/// value and the expected one. The container must outlive the reader.
class ContainerReader {
 public:
  /// most: largest absolute value of a number in a tensor.
  ContainerReader(const Container& container, float most) : container_(container), most_(most) {}

  bool has_field(const std::string& key) const { return container_.metadata.count(key) > 0; }
  bool has_tensor(const std::string& name) const { return container_.tensors.count(name) > 0; }

  const std::string& text(const std::string& key);
  double number(const std::string& key);                            ///< finite
  std::uint64_t count(const std::string& key, std::uint64_t most);  ///< a whole number in [0, most]

  const TensorShape& shape(const std::string& name) const;
  std::vector<float> values(const std::string& name, const TensorShape& expected);
  Eigen::VectorXf vector(const std::string& name, Eigen::Index size);
  Linear layer(const std::string& prefix, std::size_t layer, Eigen::Index outputs,
               Eigen::Index inputs);
  /// Layers with the shapes of `layers`.
  std::vector<Linear> layers(const std::string& prefix, std::vector<Linear> layers);

  /// To be called last: refuses entries that no method has read.
  void finish() const;

 private:
  const Container& container_;
  float most_;
  std::set<std::string> keys_, names_;  ///< entries that were read
};

}  // namespace threelink_agent
