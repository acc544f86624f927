#pragma once

#include <string>

namespace trb::drivers {

/// Ten significant digits, no superfluous zeros: "0.25", "-1.5708", "1000".
std::string number_text(double number);

}  // namespace trb::drivers
