// A map in map_server's format: YAML that names a picture, PGM or PNG.
#pragma once

#include <string>

#include "threelink_sim/world/obstacles.hpp"

namespace threelink_sim {

struct MapFile {
  OccupancyMap map;
  std::string sha256;  // of the YAML and the picture
};

// `length`: the file's length unit (metres), in L. A cell that is not free is blocked: unknown ones
// too. Throws UsageError that names the file, and the key and its bound.
MapFile read_map(const std::string& path, double length);

}  // namespace threelink_sim
