// What recorder and task both have to know of the texts in Recording messages.
#pragma once

namespace threelink_tasks {

// Begins the status of an episode that is recorded whole.
constexpr char kNothingMissing[] = "no state is missing";

}  // namespace threelink_tasks
