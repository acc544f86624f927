#include "services/scheduler/core/run/inquiry.hpp"

#include <doctest/doctest.h>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::scheduler;

namespace {

RouteTable table_with(std::vector<std::pair<std::string, std::string>> nodes_and_states) {
  RouteTable table{"ur3", {}};
  for (const auto& [id, state] : nodes_and_states) {
    Route route;
    route.id = id;
    route.state = state;
    route.profile.plugged = {{"temperature", "temperature", "degC", "28-01", "", SensorState::ok, ""}};
    table.routes.push_back(route);
  }
  return table;
}

SensorReading reading(const char* sensor = "temperature") {
  return {sensor, "28-01", "degC", false, 20, "", 1, 0, "good", 0, 0};
}

struct Asking {
  explicit Asking(const char* of = "belt", const char* identity = "")
      : inquiry("ur3", {"temperature", of, identity, Comparison::more, false, 20, "", "degC"}) {}

  Outbox tick(double s) {
    Outbox out;
    inquiry.tick(at(s), out);
    return out;
  }
  std::string asks(const RouteTable& table, double s) {
    Outbox out;
    inquiry.on(table, at(s), out);
    return sent<SensorRead>(out).empty() ? "" : out.sends.front().target;
  }

  Inquiry inquiry;
};

}  // namespace

TEST_CASE("the router is asked who has the sensor, then its node for the value") {
  Asking asking;
  CHECK(sent<RouteListRequest>(asking.tick(0)).size() == 1);
  CHECK(asking.asks(table_with({{"arm", "ONLINE"}, {"belt", "ONLINE"}}), 0) == "belt");
  CHECK(asking.inquiry.phase() == InquiryPhase::asked);
  CHECK(asking.inquiry.on(reading(), "belt", at(0.1)));
  CHECK(asking.inquiry.obstacle().empty());
}

TEST_CASE("of several nodes one is asked that can be reached, then the smallest id") {
  Asking asking("");
  asking.tick(0);
  CHECK(asking.asks(table_with({{"a", "OFFLINE"}, {"b", "CONNECTION_BROKEN"}, {"d", "ONLINE"}, {"c", "self"}}), 0) ==
        "c");
}

TEST_CASE("of two that claim one serial number neither is asked, until one has it no more or the condition names one") {
  const RouteTable both = table_with({{"belt", "ONLINE"}, {"arm", "ONLINE"}});
  Asking unnamed("", "28-01");
  unnamed.tick(0);
  CHECK(unnamed.asks(both, 0).empty());
  CHECK(unnamed.inquiry.obstacle() ==
        "temperature with serial number 28-01: 'belt' and 'arm' both say that they have it: unplug one, or name the "
        "node in the condition's \"of\"");
  unnamed.tick(0.5);
  CHECK(unnamed.asks(table_with({{"belt", "ONLINE"}, {"arm", "OFFLINE"}}), 0.5) == "belt");
  Asking named("arm", "28-01");
  named.tick(0);
  CHECK(named.asks(both, 0) == "arm");
  // Of two others that have what the named one has not, neither is better.
  Asking other("drone", "28-01");
  other.tick(0);
  CHECK(other.asks(both, 0).empty());
}

TEST_CASE("another's, another sensor's and a watch's value are no answer") {
  Asking asking;
  CHECK_FALSE(asking.inquiry.on(reading(), "belt", at(0)));  // nobody was asked
  asking.tick(0);
  asking.asks(table_with({{"belt", "ONLINE"}}), 0);
  CHECK_FALSE(asking.inquiry.on(reading(), "arm", at(0)));
  CHECK_FALSE(asking.inquiry.on(reading("humidity"), "belt", at(0)));
  SensorReading watched = reading();
  watched.watch = 3;
  CHECK_FALSE(asking.inquiry.on(watched, "belt", at(0)));
  CHECK(asking.inquiry.obstacle().empty());
  CHECK(asking.inquiry.on(reading(), "belt", at(0)));
}

TEST_CASE("every failure is tried again: after 0.5 s, doubling to 5 s") {
  Asking asking;
  double now = 0;
  for (const double wait : {0.5, 1.0, 2.0, 4.0, 5.0, 5.0}) {
    CAPTURE(wait);
    CHECK(sent<RouteListRequest>(asking.tick(now)).size() == 1);
    asking.asks(table_with({{"belt", "ONLINE"}}), now);
    asking.inquiry.on_refusal({"robot_error", "sensor_read", "ur3", "the wire is cut", ""}, "belt", at(now));
    CHECK(asking.inquiry.take_update());
    CHECK_FALSE(asking.inquiry.take_update());
    CHECK(asking.inquiry.obstacle() == "temperature of belt: 'belt' says robot_error: the wire is cut");
    CHECK(asking.tick(now + wait - 0.01).sends.empty());
    now += wait;
  }
}

TEST_CASE("a refusal of something else, or by somebody else, is not this one's") {
  Asking asking;
  asking.tick(0);
  asking.asks(table_with({{"belt", "ONLINE"}}), 0);
  asking.inquiry.on_refusal({"timeout", "baton", "belt", "", ""}, "belt", at(0));
  asking.inquiry.on_refusal({"timeout", "sensor_read", "arm", "", ""}, "arm", at(0));
  asking.inquiry.on_refusal({"peer_unreachable", "sensor_read", "arm", "not delivered", ""}, "ur3", at(0));
  CHECK(asking.inquiry.phase() == InquiryPhase::asked);
  asking.inquiry.on_refusal({"no_service", "sensor_read", "belt", "not delivered", ""}, "belt", at(0));
  CHECK(asking.inquiry.obstacle() == "temperature of belt: no sensor-bus runs on 'belt'");
}

TEST_CASE("a sensor that speaks seldom is listened for without long pauses") {
  Asking asking;
  for (int i = 0; i < 5; ++i) {
    asking.tick(10 * i);
    asking.asks(table_with({{"belt", "ONLINE"}}), 10 * i);
    asking.inquiry.on_refusal({"timeout", "sensor_read", "ur3", "no value in time", ""}, "belt", at(10 * i));
    CHECK(asking.inquiry.next() == at(10 * i + 0.5).mono);
  }
}

TEST_CASE("while a choice is being signed nothing else is listened to, and the signature is asked for again") {
  Asking asking;
  asking.tick(0);
  asking.asks(table_with({{"belt", "ONLINE"}}), 0);
  Outbox out;
  asking.inquiry.sign("choice", at(1), out);
  CHECK(sent<SignRequest>(out).size() == 1);
  CHECK_FALSE(asking.inquiry.on(reading(), "belt", at(1)));
  CHECK(asking.tick(2).sends.empty());
  CHECK(sent<SignRequest>(asking.tick(3)).size() == 1);
  CHECK(asking.inquiry.signs({"choice", "ur3", {"choice"}, {"s"}}));
  CHECK_FALSE(asking.inquiry.signs({"choice", "ur3", {"other"}, {"s"}}));
  CHECK_FALSE(asking.inquiry.signs({"result", "ur3", {"choice"}, {"s"}}));
}
