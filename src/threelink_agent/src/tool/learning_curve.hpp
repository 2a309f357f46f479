// The picture of a run.
#pragma once

#include <string>

namespace threelink_agent {

// Has plot_training, which lies beside this program, draw RUN/learning_curve.png, and waits for it.
// What goes wrong is a warning on standard error: the training is none the worse.
void draw_learning_curve(const std::string& run);

}  // namespace threelink_agent
