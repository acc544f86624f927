#include "services/cloud-gateway/core/alarms/chatter.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

UtcTime second(std::int64_t s) {
  return {s * 1'000'000'000};
}

}  // namespace

TEST_CASE("an alarm that comes three times within a minute chatters") {
  CHECK(chatter({}, second(0)) == 0);
  CHECK(chatter({second(0), second(30)}, second(31)) == 0);
  CHECK(chatter({second(0), second(30), second(60)}, second(60)) == 3);
  CHECK(chatter({second(60), second(0), second(30)}, second(60)) == 3);
  CHECK(chatter({second(0), second(30), second(61)}, second(61)) == 0);
}

TEST_CASE("it chatters on, however slowly, until it was quiet for five minutes") {
  CHECK(chatter({second(0), second(1), second(2), second(200)}, second(500)) == 4);
  CHECK(chatter({second(0), second(1), second(2), second(200)}, second(501)) == 0);
}

TEST_CASE("after that it is an alarm like any other") {
  CHECK(chatter({second(0), second(1), second(2), second(303)}, second(304)) == 0);
  CHECK(chatter({second(0), second(1), second(2), second(303), second(304), second(305)}, second(306)) == 3);
}
