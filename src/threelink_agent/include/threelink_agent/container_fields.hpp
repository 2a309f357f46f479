/// @file
/// Fields and layers of our containers, in and out: what policy files and checkpoints share.
///
/// Numbers stand in the metadata as JSON, so that they read back to the same bits, whatever the
/// locale. A layer has the names that PyTorch gives to the layers of a Sequential with a tanh after
/// each but the last: PREFIX.0.weight, PREFIX.0.bias, PREFIX.2.weight, ...
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
std::string number_text(std::uint64_t value);

std::string weight_name(const std::string& prefix, std::size_t layer);
std::string bias_name(const std::string& prefix, std::size_t layer);

void put_layers(Container& container, const std::string& prefix, const std::vector<Linear>& layers);
void put_vector(Container& container, const std::string& name, const Eigen::VectorXf& values);

/// Reads a container piece by piece. Every method throws ContainerError naming the piece, what it
/// is and what it must be; the container must outlive the reader.
class ContainerReader {
 public:
  /// most: largest absolute value that a number of a tensor may have.
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
  /// Of the shapes that `layers` have.
  std::vector<Linear> layers(const std::string& prefix, std::vector<Linear> layers);

  /// To be called at the end: refuses what none of the above asked for.
  void finish() const;

 private:
  const Container& container_;
  float most_;
  std::set<std::string> keys_, names_;  ///< asked for
};

}  // namespace threelink_agent
