#include "services/cloud-gateway/core/live/topic.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

TEST_CASE("every form of topic is read and written alike") {
  for (const char* text : {"fleet", "robot/pioneer1", "run/0123456789abcdef0123456789abcdef", "alerts",
                           "sensor/pioneer1/dht22", "messages", "teleop"}) {
    const auto topic = parse_topic(text);
    REQUIRE(topic.ok());
    CHECK(text_of(*topic) == text);
  }
}

TEST_CASE("a wrong topic: the error names the part") {
  const auto fault = [](std::string_view text) { return parse_topic(text).error().text(); };
  CHECK(fault("flet").find("'flet' is none; did you mean 'fleet'?") != std::string::npos);
  CHECK(fault("").find("topic: ") != std::string::npos);
  CHECK(fault("robot").find("robot: 0 parts behind it, and it has 1") != std::string::npos);
  CHECK(fault("fleet/x").find("1 parts behind it") != std::string::npos);
  CHECK(fault("robot/Big One").find("topic: robot") != std::string::npos);
  CHECK(fault("run/12").find("no run's id") != std::string::npos);
  CHECK(fault("sensor/p1/../x").find("3 parts") != std::string::npos);
  CHECK(fault("sensor/p1/a b").find("no sensor's name") != std::string::npos);
  CHECK(fault("sensor//dht22").find("sensor: node") != std::string::npos);
  CHECK(parse_topic(std::string(300, 'x')).error().code == Errc::too_large);
}
