#include "threelink_sim/task/task_factory.hpp"

#include <map>
#include <utility>

#include <fmt/format.h>

#include "builtin_tasks.hpp"
#include "threelink_sim/nearest_name.hpp"

namespace threelink_sim {
namespace {

std::map<std::string, TaskMaker>& registry() {
  static std::map<std::string, TaskMaker> makers = {{"clicked_point", make_clicked_point},
                                                    {"direction", make_direction},
                                                    {"path", make_path},
                                                    {"point", make_point},
                                                    {"pursuit", make_pursuit},
                                                    {"waypoints", make_waypoints}};
  return makers;
}

std::function<void()>& source() {
  static std::function<void()> find;
  return find;
}

// Those of the source included.
void find_all() {
  if (!source()) return;
  const std::function<void()> find = std::move(source());
  source() = nullptr;
  find();
}

constexpr Range<double> kSpeed{0, 1e6};  // [L/T0]

}  // namespace

void register_task(const std::string& name, const TaskMaker& make) { registry()[name] = make; }

void register_task_source(const std::function<void()>& find) { source() = find; }

std::vector<std::string> task_names() {
  find_all();
  std::vector<std::string> names;
  for (const auto& entry : registry()) names.push_back(entry.first);
  return names;
}

bool has_task(const std::string& name) {
  if (registry().count(name) == 0) find_all();
  return registry().count(name) != 0;
}

std::unique_ptr<Task> make_task(const std::string& name, ParameterMap& parameters,
                                const TaskContext& context) {
  if (!has_task(name))
    throw UsageError(fmt::format("there is no task \"{}\"; the nearest one is \"{}\"", name,
                                 nearest_name(name, task_names())));
  std::unique_ptr<Task> task = registry().at(name)();
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

}  // namespace threelink_sim
