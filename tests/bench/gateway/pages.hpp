// Many pages: clients of /api/v1/live over TLS, in one loop, that read when which robot's change has come.
#pragma once

#include <cstdint>
#include <string>

namespace trb::bench {

struct PagesSettings {
  std::uint16_t port = 0;
  std::string certificate_file;
  std::string token;
  int pages = 50;
  int stalled = 0;  ///< of them: they subscribe, and read nothing afterwards
  int robots = 1000;
  double changes = 10;  ///< a second, of each robot
  double warm_s = 3;
  double seconds = 10;
};

/// Prints "measuring" when the measurement begins, and what it has found as JSON. False: not every page was served.
bool watch_as_pages(const PagesSettings& settings);

}  // namespace trb::bench
