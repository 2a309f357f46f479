/// @file
/// One layer of a network.
#pragma once

#include <Eigen/Core>

namespace threelink_agent {

/// y = W x + b as PyTorch stores it: weight (outputs, inputs), bias (outputs).
struct Linear {
  Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor> weight;
  Eigen::VectorXf bias;
};

}  // namespace threelink_agent
