#include "map_file.hpp"

#include <cctype>
#include <cstdint>
#include <filesystem>
#include <limits>

#include <fmt/format.h>
#include <png.h>

#include "threelink_sim/fields.hpp"
#include "threelink_sim/files.hpp"
#include "threelink_sim/sha256.hpp"

namespace threelink_sim {
namespace {

constexpr std::size_t kMaxMapBytes = std::size_t{1} << 20;
constexpr std::size_t kMaxPictureBytes = std::size_t{256} << 20;
constexpr int kMaxPixels = 16384;  // in a row or column

// https://wiki.ros.org/map_server, "Map format".
struct MapDescription {
  std::string image, mode = "trinary";
  double resolution = std::numeric_limits<double>::quiet_NaN();
  double origin[3] = {std::numeric_limits<double>::quiet_NaN(), 0, 0};
  double occupied_thresh = 0.65, free_thresh = 0.196;
  int negate = 0;

  template <class Self, class Visit>
  static void fields(Self& self, Visit&& visit) {
    visit("mode", self.mode, "of the values; only trinary is known");
    visit("resolution", self.resolution, Range<double>{1e-9, 1e6}, "[m] width of a pixel");
    visit("origin", self.origin, Range<double>{-1e9, 1e9}, "[m, m, rad] of the lower left pixel");
    visit("negate", self.negate, Range<int>{0, 1}, "1: white is occupied");
    visit("occupied_thresh", self.occupied_thresh, Range<double>{0, 1}, "above: occupied");
    visit("free_thresh", self.free_thresh, Range<double>{0, 1}, "below: free");
  }
};

struct Picture {
  int width = 0, height = 0;
  std::vector<std::uint8_t> grey;  // row 0 above
};

// The next number of a PGM header; comments go to the end of their line.
int header_number(const std::string& bytes, std::size_t& at, const std::string& path) {
  while (at < bytes.size() &&
         (std::isspace(static_cast<unsigned char>(bytes[at])) || bytes[at] == '#'))
    if (bytes[at] == '#')
      at = std::min(bytes.find('\n', at), bytes.size());
    else
      ++at;
  int number = 0, digits = 0;
  for (; at < bytes.size() && std::isdigit(static_cast<unsigned char>(bytes[at])) && digits < 7;
       ++at, ++digits)
    number = 10 * number + (bytes[at] - '0');
  if (digits == 0) throw UsageError(path + ": is a damaged PGM picture: a number is missing");
  return number;
}

Picture read_pgm(const std::string& bytes, const std::string& path) {
  const bool binary = bytes[1] == '5';
  std::size_t at = 2;
  Picture picture;
  picture.width = header_number(bytes, at, path);
  picture.height = header_number(bytes, at, path);
  const int most = header_number(bytes, at, path);
  if (picture.width < 1 || picture.width > kMaxPixels || picture.height < 1 ||
      picture.height > kMaxPixels || most < 1 || most > 255)
    throw UsageError(fmt::format("{}: {} x {} pixels of 0 to {}: must be 1 to {}, and at most 255",
                                 path, picture.width, picture.height, most, kMaxPixels));
  const std::size_t pixels = static_cast<std::size_t>(picture.width) * picture.height;
  if (binary && bytes.size() != ++at + pixels)
    throw UsageError(fmt::format("{}: {} bytes of pixels: must be {}", path,
                                 at < bytes.size() ? bytes.size() - at : 0, pixels));
  for (std::size_t i = 0; i < pixels; ++i) {
    const int value =
        binary ? static_cast<unsigned char>(bytes[at + i]) : header_number(bytes, at, path);
    if (value > most)
      throw UsageError(fmt::format("{}: a pixel of {}: must be at most {}", path, value, most));
    picture.grey.push_back(static_cast<std::uint8_t>(value * 255 / most));
  }
  return picture;
}

Picture read_png(const std::string& bytes, const std::string& path) {
  png_image image{};
  image.version = PNG_IMAGE_VERSION;
  if (!png_image_begin_read_from_memory(&image, bytes.data(), bytes.size()))
    throw UsageError(fmt::format("{}: {}", path, image.message));
  Picture picture;
  if (image.width > kMaxPixels || image.height > kMaxPixels) {
    png_image_free(&image);
    throw UsageError(fmt::format("{}: {} x {} pixels: must be at most {}", path, image.width,
                                 image.height, kMaxPixels));
  }
  image.format = PNG_FORMAT_GRAY;
  picture.width = static_cast<int>(image.width);
  picture.height = static_cast<int>(image.height);
  picture.grey.resize(PNG_IMAGE_SIZE(image));
  const png_color white{255, 255, 255};
  if (!png_image_finish_read(&image, &white, picture.grey.data(), 0, nullptr))
    throw UsageError(fmt::format("{}: {}", path, image.message));
  return picture;
}

Picture read_picture(const std::string& bytes, const std::string& path) {
  if (bytes.rfind("P5", 0) == 0 || bytes.rfind("P2", 0) == 0) return read_pgm(bytes, path);
  if (bytes.rfind("\x89PNG", 0) == 0) return read_png(bytes, path);
  throw UsageError(path + ": is neither a PGM nor a PNG picture");
}

}  // namespace

MapFile read_map(const std::string& path, double length) {
  const std::string yaml = read_input(path, kMaxMapBytes);
  ParameterMap parameters = parse_parameters(path, yaml);
  MapDescription description;
  description.image = parameters.text("image");
  MapDescription::fields(description, FieldReader(parameters));
  parameters.finish();
  if (description.mode != "trinary") parameters.refuse("mode", "must be trinary");
  if (description.origin[2] != 0)
    parameters.refuse("origin", "must have no turn: its third number must be 0");
  if (description.free_thresh > description.occupied_thresh)
    parameters.refuse("free_thresh", fmt::format("must be at most occupied_thresh = {}",
                                                 description.occupied_thresh));
  const std::string picture_path =
      (std::filesystem::path(path).parent_path() / description.image).string();
  const std::string bytes = read_input(picture_path, kMaxPictureBytes);
  const Picture picture = read_picture(bytes, picture_path);

  MapFile file;
  file.sha256 = sha256(sha256(yaml) + sha256(bytes));
  OccupancyMap& map = file.map;
  map.width = picture.width;
  map.height = picture.height;
  map.resolution = description.resolution * length;
  map.origin = {description.origin[0] * length, description.origin[1] * length};
  map.blocked.resize(picture.grey.size());
  for (int j = 0; j < map.height; ++j)
    for (int i = 0; i < map.width; ++i) {
      const int grey = picture.grey[static_cast<std::size_t>(map.height - 1 - j) * map.width + i];
      const double occupied = (description.negate ? grey : 255 - grey) / 255.0;
      map.blocked[static_cast<std::size_t>(j) * map.width + i] =
          occupied >= description.free_thresh;
    }
  return file;
}

}  // namespace threelink_sim
