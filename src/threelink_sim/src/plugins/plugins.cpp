#include "threelink_sim/task/plugins.hpp"

#include <cstdlib>

#include <fmt/format.h>
#include <pluginlib/class_loader.hpp>

#include "threelink_sim/task/task_factory.hpp"

namespace threelink_sim {
namespace {

using Loader = pluginlib::ClassLoader<Task>;

std::unique_ptr<Task> make(Loader& loader, const std::string& name) {
  try {
    return std::unique_ptr<Task>(loader.createUnmanagedInstance(name));
  } catch (const pluginlib::PluginlibException& error) {
    throw UsageError(fmt::format("task \"{}\": {}", name, error.what()));
  }
}

void find_plugins() {
  if (!std::getenv("ROS_PACKAGE_PATH")) return;  // no workspace, and so no other packages
  try {
    // Lives as long as the process: the tasks' code is in the libraries that it has loaded.
    static auto* const loader = new Loader("threelink_tasks", "threelink_tasks::Task");
    for (const std::string& name : loader->getDeclaredClasses())
      if (!has_task(name)) register_task(name, [name] { return make(*loader, name); });
  } catch (const pluginlib::PluginlibException&) {
    // This package is not in the workspace that is sourced: nor is one that depends on it.
  }
}

}  // namespace

void load_task_plugins() { register_task_source(find_plugins); }

}  // namespace threelink_sim
