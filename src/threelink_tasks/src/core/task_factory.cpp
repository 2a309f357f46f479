#include "threelink_tasks/task_factory.hpp"

#include <map>

#include <fmt/format.h>

#include "builtin_tasks.hpp"
#include "threelink_sim/nearest_name.hpp"

namespace threelink_tasks {
namespace {

using threelink_sim::ParameterMap;

std::map<std::string, TaskMaker>& registry() {
  static std::map<std::string, TaskMaker> makers = {{"clicked_point", make_clicked_point},
                                                    {"direction", make_direction},
                                                    {"path", make_path},
                                                    {"point", make_point},
                                                    {"pursuit", make_pursuit},
                                                    {"waypoints", make_waypoints}};
  return makers;
}

constexpr threelink_sim::Range<double> kSpeed{0, 1e6};  // [L/T0]

}  // namespace

void register_task(const std::string& name, const TaskMaker& make) { registry()[name] = make; }

std::vector<std::string> task_names() {
  std::vector<std::string> names;
  for (const auto& entry : registry()) names.push_back(entry.first);
  return names;
}

std::unique_ptr<Task> make_task(const std::string& name, ParameterMap& parameters,
                                const TaskContext& context) {
  const auto maker = registry().find(name);
  if (maker == registry().end())
    throw threelink_sim::UsageError(
        fmt::format("there is no task \"{}\"; the nearest one is \"{}\"", name,
                    threelink_sim::nearest_name(name, task_names())));
  std::unique_ptr<Task> task = maker->second();
  task->configure(parameters, context);
  return task;
}

std::unique_ptr<Task> make_task(const YAML::Node& config) {
  ParameterMap parameters("task", config["task"]);
  ParameterMap simulator("simulator", config["simulator"]);
  TaskContext context;
  context.dt = simulator.real("dt", {1e-3, 1});
  context.v_m = parameters.real("v_m", kSpeed);
  const std::string name = parameters.text("name");
  parameters.ignore("seed");
  parameters.ignore("policy");
  std::unique_ptr<Task> task = make_task(name, parameters, context);
  parameters.finish();
  return task;
}

}  // namespace threelink_tasks
