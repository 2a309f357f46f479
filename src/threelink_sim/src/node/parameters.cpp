#include "threelink_sim/node/parameters.hpp"

#include <fmt/format.h>
#include <ros/param.h>

#include "threelink_sim/yaml.hpp"

namespace threelink_sim {
namespace {

using XmlRpc::XmlRpcValue;

// The getters of XmlRpcValue are not const.
YAML::Node to_yaml(XmlRpcValue value, const std::string& scope, std::size_t depth = 0) {
  if (depth > kMaxYamlDepth)
    throw ParameterError(fmt::format("{}: nested more than {} deep", scope, kMaxYamlDepth));
  YAML::Node node;
  switch (value.getType()) {
    case XmlRpcValue::TypeBoolean:
      node = static_cast<bool>(value);
      break;
    case XmlRpcValue::TypeInt:
      node = static_cast<int>(value);
      break;
    case XmlRpcValue::TypeDouble:
      node = yaml_number(value);
      break;
    case XmlRpcValue::TypeString:
      node = static_cast<std::string&>(value);
      node.SetTag("!");  // text, even if it looks like a number
      break;
    case XmlRpcValue::TypeArray:
      node = YAML::Node(YAML::NodeType::Sequence);
      for (int i = 0; i < value.size(); ++i) node.push_back(to_yaml(value[i], scope, depth + 1));
      break;
    case XmlRpcValue::TypeStruct:
      node = YAML::Node(YAML::NodeType::Map);
      for (auto& item : value) node[item.first] = to_yaml(item.second, scope, depth + 1);
      break;
    default:
      break;
  }
  return node;
}

XmlRpcValue values_under(const std::string& scope) {
  XmlRpcValue values;
  ros::param::get(scope, values);
  return values;
}

}  // namespace

Parameters::Parameters(const ros::NodeHandle& private_handle)
    : Parameters(private_handle.getNamespace(), values_under(private_handle.getNamespace())) {}

Parameters::Parameters(const std::string& scope, const XmlRpcValue& values)
    : ParameterMap(scope, to_yaml(values, scope)) {}

}  // namespace threelink_sim
