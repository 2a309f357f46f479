#include "threelink_sim/plugins.hpp"

#include <cstdlib>

#include <fmt/format.h>
#include <pluginlib/class_loader.hpp>

#include "threelink_sim/task/task_factory.hpp"
#include "threelink_sim/usage_error.hpp"
#include "threelink_sim/world/flow.hpp"

namespace threelink_sim {
namespace {

// Registers each class that derives from Base and that is exported to `package`.
template <class Base, class Has, class Register>
void find_plugins(const char* package, const char* base, const char* what, Has has, Register add) {
  if (!std::getenv("ROS_PACKAGE_PATH")) return;  // no workspace, and so no other packages
  using Loader = pluginlib::ClassLoader<Base>;
  try {
    // Lives as long as the process: the code of the plug-ins is in the libraries that it has
    // loaded.
    static auto* const loader = new Loader(package, base);
    for (const std::string& name : loader->getDeclaredClasses())
      if (!has(name))
        add(name, [name, what] {
          try {
            return std::unique_ptr<Base>(loader->createUnmanagedInstance(name));
          } catch (const pluginlib::PluginlibException& error) {
            throw UsageError(fmt::format("{} \"{}\": {}", what, name, error.what()));
          }
        });
  } catch (const pluginlib::PluginlibException&) {
    // This package is not in the workspace that is sourced: nor is one that depends on it.
  }
}

}  // namespace

void load_plugins() {
  register_task_source([] {
    find_plugins<Task>("threelink_tasks", "threelink_tasks::Task", "task", has_task, register_task);
  });
  register_flow_source([] {
    find_plugins<Flow>("threelink_sim", "threelink_sim::Flow", "flow", has_flow, register_flow);
  });
}

}  // namespace threelink_sim
