// What is shown on a terminal.
#pragma once

#include <cstddef>
#include <string>

namespace threelink_agent {

// Prints to standard output, to standard error. Unlike fmt::print() they never throw: that nobody
// takes the text is no reason to end a training, and is told at its end.
void say(const std::string& text);
void complain(const std::string& text);

std::string duration(double seconds);  // "95 s", "17 min", "2 h 5 min"

// "[####........]"; done: 0 .. 1.
std::string bar(double done, int width = 12);

// Of standard output; 80 x 24 where it does not say.
struct TerminalSize {
  std::size_t columns, rows;
};
TerminalSize terminal_size();

}  // namespace threelink_agent
