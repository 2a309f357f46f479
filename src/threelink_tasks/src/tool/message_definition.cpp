#include "message_definition.hpp"

#include <sstream>
#include <vector>

namespace threelink_tasks {
namespace {

// A line as words with one blank between them. A text constant reaches to the end of its line.
std::string plain(const std::string& line) {
  const bool text = line.find("string ") != std::string::npos &&
                    line.find('=') != std::string::npos && line.find('#') > line.find('=');
  std::istringstream words(text ? line : line.substr(0, line.find('#')));
  std::string result, word;
  while (words >> word) result += (result.empty() ? "" : " ") + word;
  return result;
}

std::vector<std::string> lines_of(const std::string& definition) {
  std::vector<std::string> lines;
  std::istringstream stream(definition);
  for (std::string line; std::getline(stream, line);)
    if (line = plain(line); !line.empty()) lines.push_back(line);
  return lines;
}

}  // namespace

bool same_definition(const std::string& one, const std::string& other) {
  return one == other || lines_of(one) == lines_of(other);
}

}  // namespace threelink_tasks
