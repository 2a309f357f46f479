// Definitions of messages as bags hold them: the text of a .msg file and of all that it needs.
#pragma once

#include <string>

namespace threelink_tasks {

// Whether both say the same but for comments, blanks and empty lines.
bool same_definition(const std::string& one, const std::string& other);

}  // namespace threelink_tasks
