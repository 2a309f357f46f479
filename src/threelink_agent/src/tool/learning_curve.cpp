#include "learning_curve.hpp"

#include <cerrno>
#include <cstring>
#include <filesystem>

#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include "terminal.hpp"

namespace threelink_agent {

void draw_learning_curve(const std::string& run) {
  const std::string program =
      std::filesystem::read_symlink("/proc/self/exe").parent_path() / "plot_training";
  const char* const arguments[] = {program.c_str(), run.c_str(), nullptr};
  pid_t child;
  const int error = posix_spawn(&child, program.c_str(), nullptr, nullptr,
                                const_cast<char* const*>(arguments), environ);
  if (error != 0) {
    complain(fmt::format("warning: no learning curve: {}: {}\n", program, std::strerror(error)));
    return;
  }
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  if (status != 0) complain("warning: no learning curve: plot_training failed\n");
}

}  // namespace threelink_agent
