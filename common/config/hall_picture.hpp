// NODE_DIR/hall.svg of a cloud node: the hall's walls, drawn below the page's map.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "common/base/config_fault.hpp"
#include "common/base/result.hpp"

namespace trb {

/// Where the picture's edges lie in the hall's frame: metres, x to the east, y to the north.
struct HallBox {
  double west = 0;
  double south = 0;
  double east = 0;
  double north = 0;
};

struct HallPicture {
  HallBox box;
  std::string svg;
};

/// By the picture's viewBox, "WEST -NORTH WIDTH HEIGHT": a unit is a metre, and y grows downwards in a picture.
/// Errors: missing, bad_value.
Result<HallBox> hall_box_of(std::string_view svg);

/// The file is optional. Nothing, with a fault: it is larger than 1 MB, cannot be read, or has no such viewBox.
std::optional<HallPicture> read_hall_picture(const std::string& node_dir, ConfigFaults& faults);

}  // namespace trb
