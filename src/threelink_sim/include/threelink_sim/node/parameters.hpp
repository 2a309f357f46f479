// Strict reading of a node's private parameters: what is wrong is an error, never a default.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

#include <ros/node_handle.h>
#include <xmlrpcpp/XmlRpcValue.h>

#include "threelink_sim/node/node_main.hpp"

namespace threelink_sim {

// what() gives the parameter's full name, its value, its type and what it must be.
class ParameterError : public UsageError {
 public:
  using UsageError::UsageError;
};

// Closed interval.
template <class T>
struct Range {
  T low;
  T high;
};

// Every getter throws ParameterError if the parameter is of another type or out of range, or if it
// is absent and has no default. A whole number is accepted where a real one is wanted, not the
// other way round; NaN and infinities never are.
class Parameters {
 public:
  // Reads all private parameters of this node at once.
  explicit Parameters(const ros::NodeHandle& private_handle);
  // From a struct of values; `scope` is what their names begin with in messages.
  Parameters(const std::string& scope, const XmlRpc::XmlRpcValue& values);

  double real(const std::string& name, Range<double> range, std::optional<double> fallback = {});
  int integer(const std::string& name, Range<int> range, std::optional<int> fallback = {});
  bool flag(const std::string& name, std::optional<bool> fallback = {});
  std::string text(const std::string& name, std::optional<std::string> fallback = {});
  // One of several words.
  std::string choice(const std::string& name, const std::vector<std::string>& words,
                     std::optional<std::string> fallback = {});

  // To be called after the last getter: refuses parameters that no getter asked for, and names the
  // nearest one that exists.
  void finish() const;

  // For values that are well formed and yet wrong, such as the name of a broken file.
  [[noreturn]] void refuse(const std::string& name, const std::string& reason) const;

 private:
  // Null if it is absent and may be.
  const XmlRpc::XmlRpcValue* find(const std::string& name, bool required);

  std::string scope_;
  XmlRpc::XmlRpcValue values_;
  std::set<std::string> known_;
};

}  // namespace threelink_sim
