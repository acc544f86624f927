#include "services/scheduler/core/handlers/condition_handler.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/core/handlers/route_handler.hpp"
#include "services/scheduler/test/condition_story.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

using Names = std::vector<std::string>;

/// The ridgeback evaluates the conditions, and has done the preceding task.
struct Choosing {
  Choosing() { known.finish("bring"); }

  Outbox at_end_of_step() {
    Outbox out;
    handler.inquire(known.run(), known.step(out));
    return out;
  }
  Outbox tell_routes(const std::string& from = "ridgeback") {
    Route route;
    route.id = "conveyor";
    route.state = "ONLINE";
    route.profile.plugged = {{"temperature", "temperature", "degC", "28-01", "", SensorState::ok, ""}};
    return known.send(routes, from, RouteTable{"ridgeback", {route}}, MessageType::information);
  }
  Outbox tell_value(double degrees) {
    return known.send(handler, "conveyor",
                      SensorReading{"temperature", "28-01", "degC", false, degrees, "", 1, 0, "good", 0, 0},
                      MessageType::information);
  }
  bool keep(const SignedRecord& record) {
    Outbox out;
    return handler.keep_signed(known.run(), record, known.step(out));
  }

  KnownRun known{left_or_right("ur3", "drone"), "ridgeback"};
  ConditionHandler handler{known.self, known.runs, known.journal};
  DefinitionHandler definitions{known.self, known.runs, known.lookup, known.journal, [](const Inbound&, Step) {}};
  AwaitedRobots robots{known.self, known.runs};
  RouteHandler routes{known.self, handler, definitions, robots};
};

}  // namespace

TEST_CASE("the router is asked who has the sensor, its node for the value, the router for the signature") {
  Choosing choosing;
  CHECK(targets<RouteListRequest>(choosing.at_end_of_step()) == Names{"ridgeback"});
  CHECK(targets<SensorRead>(choosing.tell_routes()) == Names{"conveyor"});
  const SignedRecord choice = signed_by(choosing.known.signers, "ridgeback", choosing.tell_value(19.9));
  CHECK(choosing.known.run().facts().choice_on(1) == nullptr);
  CHECK(choosing.keep(choice));
  CHECK(choosing.known.run().facts().fate_of(1) == Fate::goes);
  CHECK(choosing.known.run().facts().fate_of(2) == Fate::skipped);
  CHECK(choosing.known.run().work().inquiries().empty());
}

TEST_CASE("only the own router says who is reached, and a value that nobody asked for is counted") {
  Choosing choosing;
  choosing.at_end_of_step();
  CHECK(nacks(choosing.tell_routes("drone")).size() <= 1);
  CHECK(targets<SensorRead>(choosing.tell_routes("drone")).empty());
  CHECK(choosing.tell_value(20).counts == Names{"unused.sensor_reading"});
}

TEST_CASE("what a condition waits for is told to the clouds") {
  Choosing choosing;
  choosing.at_end_of_step();
  choosing.tell_routes();
  Outbox out;
  const Nack nack{"robot_error", "sensor_read", "ridgeback", "the wire is cut", ""};
  choosing.handler.on_refusal(nack, choosing.known.from("conveyor", MessageType::information, nack),
                              choosing.known.step(out));
  const auto told = sent<TaskProgress>(choosing.at_end_of_step());
  REQUIRE(told.size() == 2);
  CHECK(told[0].detail == "temperature of conveyor: 'conveyor' says robot_error: the wire is cut");
}

TEST_CASE("a run that is held asks for no value") {
  Choosing choosing;
  choosing.at_end_of_step();
  REQUIRE(choosing.known.run().apply(JournalPause{choosing.known.pause(1, true), false}).ok());
  CHECK(choosing.at_end_of_step().sends.empty());
  CHECK(choosing.known.run().work().inquiries().empty());
}
