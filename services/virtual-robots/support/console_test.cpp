#include "services/virtual-robots/support/console.hpp"

#include <doctest/doctest.h>
#include <sys/eventfd.h>

#include "services/virtual-robots/support/robot_clock.hpp"

using namespace trb::virtual_robots;

TEST_CASE("a console waits until the deadline, and no longer than until its end is asked for") {
  const Console console(std::nullopt);
  const Fd end(::eventfd(0, EFD_CLOEXEC));
  std::vector<pollfd> polled = console.to_poll(end);
  CHECK(Console::wait(polled, wall_seconds() + 0.01));
  REQUIRE(::eventfd_write(end.get(), 1) == 0);
  polled = console.to_poll(end);
  CHECK_FALSE(Console::wait(polled, wall_seconds() + 60));
}

TEST_CASE("a robot's clock runs at its speed; what never comes has no deadline") {
  const RobotClock clock(10);
  CHECK(clock.deadline(20) == doctest::Approx(clock.begin() + 2));
  CHECK(clock.deadline({}) > 1e300);
  const double before = clock.now();
  CHECK(clock.now() >= before);
}
