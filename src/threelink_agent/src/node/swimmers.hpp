// The swimmers whose observations come in, and whether a policy may play for them.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <boost/shared_ptr.hpp>
#include <ros/datatypes.h>

#include "threelink_agent/policy.hpp"

namespace threelink_agent {

class Swimmers {
 public:
  // allow_other: a policy may play for a swimmer that it was not trained for.
  explicit Swimmers(bool allow_other) : allow_other_(allow_other) {}

  // Why this policy does not play for the swimmer behind a connection, with both values; empty if
  // it does. Asks the parameter server the first time that a connection is seen, and else neither
  // asks nor allocates.
  const std::string& refusal(const boost::shared_ptr<ros::M_string>& connection,
                             const PolicyMetadata& policy);
  // The same for the swimmer that was heard of last; empty if there was none.
  std::string refusal(const PolicyMetadata& policy) const;
  // Another policy is in use.
  void forget_refusals();

 private:
  struct Swimmer {
    boost::shared_ptr<ros::M_string> connection;  // kept, so that no other has its address
    std::string node;
    std::optional<threelink_sim::EnvironmentConfig> is;  // if the node's parameters say it
    std::string unreadable;                              // why they do not
    std::optional<std::string> refusal;                  // of the policy in use
  };

  Swimmer& meet(const boost::shared_ptr<ros::M_string>& connection);
  std::string refusal_of(const Swimmer& swimmer, const PolicyMetadata& policy) const;

  bool allow_other_;
  std::vector<Swimmer> swimmers_;  // the one heard of last is the last one
};

}  // namespace threelink_agent
