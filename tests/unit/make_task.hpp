// Tasks from a line of YAML, for tests.
#pragma once

#include <memory>
#include <string>

#include "threelink_tasks/task_factory.hpp"

namespace threelink_tests {

// dt = 0.1; v_m [L/T0] is the speed of the policy.
inline std::unique_ptr<threelink_tasks::Task> make_task(const std::string& name,
                                                        const std::string& yaml = "{}",
                                                        double v_m = 0.0128) {
  threelink_sim::ParameterMap parameters("p", YAML::Load(yaml));
  auto task = threelink_tasks::make_task(name, parameters, {0.1, v_m});
  parameters.finish();
  return task;
}

}  // namespace threelink_tests
