// A driver alone, with all that it reports and writes, for the targets of drivers.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "common/drivers/driver.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {

/// Its connection for commands is up.
struct DriverUnderTest {
  explicit DriverUnderTest(Result<std::unique_ptr<drivers::Driver>> made) {
    require(made.ok(), "its commands can be read");
    mode = std::move(*made);
    mode->on_up(Channel::command, now, to());
  }
  [[nodiscard]] drivers::DriverOut to() { return {mode.get(), out, robot, events}; }

  std::unique_ptr<drivers::Driver> mode;
  Now now{{10'000'000'000}, {0}};
  Outbox out;
  std::vector<drivers::EventFrom> events;
  RobotOutbox robot;
};

}  // namespace trb::fuzz
