#include "swimmers.hpp"

#include <algorithm>

#include <fmt/format.h>
#include <ros/console.h>

#include "threelink_sim/node/swimmer_parameters.hpp"
#include "threelink_sim/parameter_map.hpp"

namespace threelink_agent {
namespace {

constexpr std::size_t kMost = 16;  // connections that are remembered

std::string publisher(const ros::M_string& connection) {
  const auto found = connection.find("callerid");
  return found == connection.end() ? "" : found->second;
}

}  // namespace

const std::string& Swimmers::refusal(const boost::shared_ptr<ros::M_string>& connection,
                                     const PolicyMetadata& policy) {
  if (swimmers_.empty() || swimmers_.back().connection != connection) meet(connection);
  Swimmer& swimmer = swimmers_.back();
  if (!swimmer.refusal) swimmer.refusal = refusal_of(swimmer, policy);
  return *swimmer.refusal;
}

std::string Swimmers::refusal(const PolicyMetadata& policy) const {
  return swimmers_.empty() ? "" : refusal_of(swimmers_.back(), policy);
}

void Swimmers::forget_refusals() {
  for (Swimmer& swimmer : swimmers_) swimmer.refusal.reset();
}

Swimmers::Swimmer& Swimmers::meet(const boost::shared_ptr<ros::M_string>& connection) {
  const auto known = std::find_if(swimmers_.begin(), swimmers_.end(), [&](const Swimmer& swimmer) {
    return swimmer.connection == connection;
  });
  if (known != swimmers_.end()) {
    std::rotate(known, known + 1, swimmers_.end());
    return swimmers_.back();
  }
  Swimmer swimmer{connection, connection ? publisher(*connection) : "", {}, "", {}};
  try {
    if (!swimmer.node.empty()) swimmer.is = threelink_sim::swimmer_of_node(swimmer.node);
  } catch (const threelink_sim::ParameterError& error) {
    swimmer.unreadable = error.what();
  }
  if (!swimmer.is && swimmer.unreadable.empty())
    ROS_WARN("the parameters of %s do not say what swimmer it is (links, gamma, joint_limit, dt)",
             swimmer.node.c_str());
  if (swimmers_.size() == kMost) swimmers_.erase(swimmers_.begin());
  swimmers_.push_back(swimmer);
  return swimmers_.back();
}

std::string Swimmers::refusal_of(const Swimmer& swimmer, const PolicyMetadata& policy) const {
  if (!swimmer.unreadable.empty()) return swimmer.unreadable;
  threelink_sim::EnvironmentConfig wanted = policy.environment();
  if (!swimmer.is) return "";
  if (allow_other_) {  // but no policy has the right number of inputs and outputs for other links
    const int links = wanted.model.links;
    wanted = *swimmer.is;
    wanted.model.links = links;
  }
  const std::string difference = threelink_sim::swimmer_difference(*swimmer.is, wanted);
  if (difference.empty()) return "";
  return fmt::format("{} is another swimmer than the policy was trained for: {}{}", swimmer.node,
                     difference,
                     swimmer.is->model.links == wanted.model.links
                         ? " (~allow_other_swimmer plays it all the same)"
                         : "");
}

}  // namespace threelink_agent
