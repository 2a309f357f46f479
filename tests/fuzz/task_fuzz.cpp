// A task and its parameters as config/*.yaml, a goal or a bag gives them.
#include "fuzz.hpp"
#include "threelink_tasks/task_factory.hpp"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using threelink_sim::ParameterMap;
  threelink_fuzz::value_or<threelink_sim::UsageError>([&] {
    ParameterMap parameters =
        threelink_sim::parse_parameters("input", threelink_fuzz::text(data, size));
    const std::string name = parameters.text("task");
    const auto task = threelink_tasks::make_task(name, parameters, {0.1, 0.0129});
    parameters.finish();
    // One that is accepted plays.
    task->reset(1, 1);
    for (int step = 0; step < 3; ++step) task->observe(task->start().x_1);
  });
  return 0;
}
