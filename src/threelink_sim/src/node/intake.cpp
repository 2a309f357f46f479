#include "threelink_sim/node/intake.hpp"

#include <fmt/format.h>

namespace threelink_sim {

void Intake::refuse(std::size_t bytes, const boost::shared_ptr<ros::M_string>& header,
                    const char* reason) {
  if (malformed_) ++*malformed_;
  std::string sender = "unknown";
  if (header) {
    const auto found = header->find("callerid");
    if (found != header->end()) sender = found->second;
  }
  log_.error(fmt::format("refused {} bytes of {} on {}, which are no message of its type: {}",
                         bytes, sender, name_, reason));
}

}  // namespace threelink_sim
