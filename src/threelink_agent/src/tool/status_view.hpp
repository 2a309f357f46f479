// A training at a glance: threelink_msgs/TrainingStatus as text.
#pragma once

#include <string>
#include <vector>

#include <threelink_msgs/TrainingStatus.h>

#include "terminal.hpp"

namespace threelink_agent {

// From this age [s] on a status is shown with its age: a learner says something once a second.
constexpr double kOldStatus = 3;

// One line. age: [s] of the message.
std::string status_line(const threelink_msgs::TrainingStatus& status, double age);

// A screen full: the training, and a table of its workers. Those in trouble come first, since those
// that find no room are left out, and counted.
std::vector<std::string> status_screen(const threelink_msgs::TrainingStatus& status, double age,
                                       const TerminalSize& size);

}  // namespace threelink_agent
