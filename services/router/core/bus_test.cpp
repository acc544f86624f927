// The node's own bus: claims, probes and visitors.
#include <doctest/doctest.h>

#include "services/router/test/test_bus.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("a full disk is shown with the router, and no longer once there is room") {
  Bus bus;
  RouterConfig config = bus.ant.core->config();
  std::string note = "the disk of /n is full; make room";
  config.machine_note = [&] { return note; };
  const RouterCore core(std::move(config));
  const auto is_noted = [&] {
    const auto table = core.answers().service_table(bus.fleet.now);
    return table.services.at(0).note.find("the disk of /n is full; make room") != std::string::npos;
  };
  CHECK(is_noted());
  note.clear();
  CHECK_FALSE(is_noted());
}

TEST_CASE("what a service waits for is its note, until it comes again and works") {
  Bus bus;
  const auto come = [&](ConnectionId from, std::uint64_t instance, const std::string& waits) {
    Effects effects;
    bus.ant.core->bus().on_hello(from, {"scheduler", {"baton"}, instance, 100, "1", {}, waits}, "scheduler",
                                 bus.fleet.now, effects);
    bus.fleet.carry_out(bus.ant, effects);
    for (const ServiceEntry& entry : bus.ant.core->answers().service_table(bus.fleet.now).services) {
      if (entry.service == "scheduler") return entry.state + ": " + entry.note;
    }
    return std::string();
  };
  CHECK(come(1, 5, "state/journal.db: cannot open; chown it") ==
        "up: it waits: state/journal.db: cannot open; chown it");
  bus.gone(1);
  CHECK(come(2, 6, "") == "up: ");
}

TEST_CASE("what a service says of itself with its sign of life is its note, until it says another") {
  Bus bus;
  const auto note = [&] {
    for (const ServiceEntry& entry : bus.ant.core->answers().service_table(bus.fleet.now).services) {
      if (entry.service == "scheduler") return entry.note;
    }
    return std::string("no such service");
  };
  REQUIRE(bus.hello(1, "scheduler") == "service_welcome");
  CHECK(note().empty());
  CHECK(bus.ask(1, ServiceAlive{100, "cannot write x; make room"}) == "service_alive_seen");
  CHECK(note() == "cannot write x; make room");
  CHECK(bus.ask(1, ServiceAlive{100}) == "service_alive_seen");
  CHECK(note().empty());
}

TEST_CASE("an operator's service takes users' words, and hears the middleware's without taking them") {
  Bus bus;
  CHECK(bus.hello(1, "fault-tally", {"fault_tally"}) == "service_welcome");
  bus.gone(1);
  CHECK(bus.hello(1, "fault-tally", {"fault_tally", "execute"}) == "not_permitted");
  CHECK(bus.hello(2, "mode-adapter", {"execute"}) == "service_welcome");
  CHECK(bus.hello(3, "not-in-node-json", {"a_word"}) == "not_permitted");
  Effects effects;
  bus.ant.core->bus().on_hello(1, {"fault-tally", {"fault_tally"}, 5, 100, "1", {"robot_fault"}}, "fault-tally",
                               bus.fleet.now, effects);
  bus.fleet.carry_out(bus.ant, effects);
  const Message fault = make_message(MessageType::information, "bee", "*", RobotFault{});
  CHECK(bus.ant.core->bus().copies_for(header_of(fault)) == std::vector<ConnectionId>{1});
}

TEST_CASE("a service and a subtype have one holder; when that is gone, the next may come") {
  Bus bus;
  CHECK(bus.hello(1, "scheduler", {"baton"}) == "service_welcome");
  CHECK(bus.hello(2, "scheduler") == "already_claimed");
  CHECK(bus.hello(3, "resilience", {"baton"}) == "already_claimed");
  CHECK(bus.hello(4, "resilience", {"no word"}) == "bad_value");
  CHECK(bus.hello(5, "stranger") == "not_permitted");
  bus.gone(1);
  CHECK(bus.hello(2, "scheduler", {"baton"}) == "service_welcome");
}

TEST_CASE(
    "a hello that is said again keeps its slot: what is under way bears it; one of another start gets a new one") {
  Bus bus;
  const auto slot = [&](ConnectionId from, std::uint64_t instance) {
    Effects effects;
    bus.ant.core->bus().on_hello(from, {"trb", {}, instance, 100, "1"}, kProbe, bus.fleet.now, effects);
    bus.fleet.carry_out(bus.ant, effects);
    return decode<ServiceWelcome>(bus.ant.bus.back().message.data)->slot;
  };
  const auto first = slot(1, 7);
  CHECK(slot(1, 7) == first);
  CHECK(slot(2, 7) != first);
  CHECK(slot(1, 8) != first);
}

TEST_CASE("several services hear one information, whether or not somebody takes it") {
  Bus bus;
  const auto hear = [&](ConnectionId from, const std::string& service, std::vector<std::string> hears) {
    Effects effects;
    bus.ant.core->bus().on_hello(from, {service, {}, 5, 100, "1", std::move(hears)}, service, bus.fleet.now, effects);
    bus.fleet.carry_out(bus.ant, effects);
    return bus.ant.bus.back().message.subtype;
  };
  const auto subscribers = [&](const Message& message) { return bus.ant.core->bus().copies_for(header_of(message)); };
  using Ids = std::vector<ConnectionId>;
  CHECK(hear(1, "scheduler", {"robot_fault", "robot_fault"}) == "service_welcome");
  CHECK(hear(2, "resilience", {"robot_fault", "peer_expired"}) == "service_welcome");
  CHECK(hear(3, "mode-adapter", {"move"}) == "nack");
  const Message fault = make_message(MessageType::information, "bee", "*", RobotFault{"grab", Severity::fatal, "x"});
  CHECK(subscribers(fault) == Ids{1, 2});
  Message command = fault;
  command.type = MessageType::command;
  CHECK(subscribers(command).empty());
  Message answer = fault;
  answer.reply_to = 7;
  CHECK(subscribers(answer).empty());
  bus.gone(2);
  CHECK(subscribers(fault) == Ids{1});
}

TEST_CASE("a service is who its socket or key proves, whatever it says, and a probe is none") {
  Bus bus;
  CHECK(bus.come_as("mode-adapter", 1, "scheduler", {"baton"}) == "source_mismatch");
  CHECK(bus.ant.count("refused.impersonation") == 1);
  CHECK(bus.come_as("scheduler", 2, "mode-adapter", {"stop"}) == "source_mismatch");
  CHECK(bus.come_as("router", 3, "router", {"stop"}) == "not_permitted");
  CHECK(bus.come_as(kProbe, 4, "scheduler", {"baton"}) == "service_welcome");
  CHECK_FALSE(bus.ant.core->bus().services().holder("scheduler"));
  CHECK(bus.come_as("scheduler", 5, "scheduler", {"baton"}) == "service_welcome");
  CHECK(bus.ant.count("refused.impersonation") == 2);
}

TEST_CASE("probes that ended unnoticed do not fill the bus for ever") {
  Bus bus;
  for (ConnectionId id = 1; id <= kMaxConnections; ++id) CHECK(bus.hello(id, "trb", {}, true) == "service_welcome");
  CHECK(bus.hello(100, "trb", {}, true) == "queue_full");
  CHECK(bus.hello(101, "scheduler") == "service_welcome");
  bus.fleet.run(Seconds(11));
  CHECK(bus.hello(100, "trb", {}, true) == "service_welcome");
  CHECK(bus.ant.told(HelloWanted::kSubtype) == kMaxConnections);
}

TEST_CASE("a service's key lets the doctor in beside the service, as a visitor; another's name does not") {
  Bus bus;
  CHECK(bus.come_as("scheduler", 1, "scheduler.doctor") == "service_welcome");
  CHECK_FALSE(bus.ant.core->bus().services().holder("scheduler.doctor"));
  CHECK(bus.hello(2, "scheduler", {"baton"}) == "service_welcome");
  CHECK(bus.ask(1, ServiceListRequest{}) == "service_table");
  CHECK(bus.come_as("scheduler", 3, "mode-adapter.doctor") == "not_permitted");
  bus.gone(1);
  CHECK(bus.ant.core->bus().services().holder("scheduler") == 2);
}

TEST_CASE("a visitor asks its own node how the services are, and nothing else") {
  Bus bus{Role::cloud};
  REQUIRE(bus.come_as("scheduler", 1, "scheduler.doctor", {"baton"}) == "service_welcome");
  CHECK_FALSE(bus.ant.core->bus().services().by_subtype("baton"));
  const std::uint64_t slot = bus.ant.core->bus().services().find(1)->slot;
  const auto way = [&](const std::string& target, std::string_view subtype, MessageType type) {
    Message message = make_message(type, "ant", target, ServiceListRequest{});
    message.subtype = subtype;
    message.id = slot << 48U | 1U;
    return bus.ant.core->routing().from_bus(1, header_of(message));
  };
  CHECK(way("ant", ServiceListRequest::kSubtype, MessageType::request).to == Routing::To::router);
  CHECK(way("bee", ServiceListRequest::kSubtype, MessageType::request).reason == Errc::not_permitted);
  for (const std::string_view subtype : {"route_list", "run_submit", "stop", "execute", "sign_request", "a_word"}) {
    CAPTURE(subtype);
    CHECK(way("ant", subtype, MessageType::command).reason == Errc::not_permitted);
  }
  for (const auto kind : {kSignedResult, kSignedRunStart, kSignedRunAbort})
    CHECK(bus.ask(1, SignRequest{std::string(kind), {payload_of(kind, "ant")}}) == "not_permitted");
}

TEST_CASE("a service has one visitor: its key cannot fill the bus") {
  Bus bus;
  for (ConnectionId id = 1; id <= 2 * kMaxConnections; ++id)
    CHECK(bus.come_as("scheduler", id, "scheduler.doctor") == "service_welcome");
  CHECK(bus.ant.core->bus().services().all().size() == 1);
  CHECK(bus.hello(1000, "trb", {}, true) == "service_welcome");
}

TEST_CASE("the tables are for requests, and only the mode-adapter tells the profile") {
  Bus bus;
  REQUIRE(bus.hello(1, "mode-adapter", {}, true) == "service_welcome");
  CHECK(bus.ask(1, RouteListRequest{}) == "route_table");
  CHECK(bus.ask(1, ServiceListRequest{}) == "service_table");
  CHECK(bus.ask(1, RouterCountersRequest{}) == "counters");
  NodeProfile profile;
  profile.maker = "forged";
  bus.ask(1, profile);
  CHECK(bus.ant.core->answers().route_table(bus.fleet.now).routes.at(0).profile.maker.empty());
}

TEST_CASE(
    "a request for counters goes to the service that it names; the router answers for itself and for the absent") {
  Bus bus;
  REQUIRE(bus.hello(1, "scheduler", {"baton"}) == "service_welcome");
  REQUIRE(bus.hello(2, "trb", {}, true) == "service_welcome");
  const std::uint64_t slot = bus.ant.core->bus().services().find(2)->slot;
  const auto way = [&](Message message) {
    message.id = slot << 48U | 1U;
    return bus.ant.core->routing().from_bus(2, header_of(message));
  };
  const auto request = [](const std::string& service) {
    return make_message(MessageType::request, "ant", "ant", ServiceCountersRequest{service});
  };
  const Routing to_scheduler = way(request("scheduler"));
  CHECK(to_scheduler.to == Routing::To::service);
  CHECK(to_scheduler.connection == 1);
  Message order = request("scheduler");
  order.type = MessageType::command;
  Message malformed = request("scheduler");
  malformed.data = "\xc1";
  for (const Message& other : {request("router"), request("resilience"), request("trb"), order, malformed})
    CHECK(way(other).to == Routing::To::router);
  CHECK(bus.ask(2, ServiceCountersRequest{"router"}) == "counters");
  CHECK(bus.ask(2, ServiceCountersRequest{"resilience"}) == "no_service");
}

TEST_CASE("a service that says hello again has what it says now, once, and what it said before no longer") {
  Bus bus;
  const auto hello = [&](std::vector<std::string> subtypes, std::vector<std::string> hears) {
    Effects effects;
    bus.ant.core->bus().on_hello(1, {"scheduler", std::move(subtypes), 5, 100, "1", std::move(hears)}, "scheduler",
                                 bus.fleet.now, effects);
    bus.fleet.carry_out(bus.ant, effects);
    return decode<ServiceWelcome>(bus.ant.bus.back().message.data)->slot;
  };
  const auto slot = hello({"baton", "relay_race"}, {"robot_fault"});
  CHECK(hello({"baton"}, {"robot_fault"}) == slot);
  const Message fault = make_message(MessageType::information, "bee", "*", RobotFault{});
  CHECK(bus.ant.core->bus().copies_for(header_of(fault)) == std::vector<ConnectionId>{1});
  CHECK(bus.hello(2, "resilience", {"baton"}) == "already_claimed");
  CHECK(bus.hello(2, "resilience", {"relay_race"}) == "service_welcome");
}

TEST_CASE("a connection that is now somebody else's has a slot of its own; a probe hears any word") {
  Bus bus;
  const auto slot = [&](const std::string& service, bool probe) {
    Effects effects;
    bus.ant.core->bus().on_hello(1, {service, {}, 7, 100, "1", {"move"}}, probe ? kProbe : std::string_view(service),
                                 bus.fleet.now, effects);
    bus.fleet.carry_out(bus.ant, effects);
    const Message& last = bus.ant.bus.back().message;
    return last.subtype == ServiceWelcome::kSubtype ? decode<ServiceWelcome>(last.data)->slot : 0;
  };
  const auto first = slot("scheduler", true);
  REQUIRE(first != 0);
  const auto second = slot("trb", true);
  CHECK(second != first);
  CHECK(bus.hello(1, "scheduler") == "service_welcome");
  const auto proven = decode<ServiceWelcome>(bus.ant.bus.back().message.data)->slot;
  CHECK(proven != second);
  CHECK(slot("scheduler", true) != proven);
}

TEST_CASE("of counters with made-up names there are a thousand, and those that are there go on") {
  Bus bus;
  RouterCore& core = *bus.ant.core;
  core.counters().count("known");
  for (int i = 0; i < 2000; ++i) core.counters().count("made_up." + std::to_string(i));
  int there = 0;
  for (int i = 0; i < 2000; ++i) there += core.counters().value("made_up." + std::to_string(i)) == 0 ? 0 : 1;
  CHECK(there == 999);
  core.counters().count("known", 2);
  CHECK(core.counters().value("known") == 3);
}

TEST_CASE("a service that says that it is alive is told of which start this router is") {
  Bus bus;
  REQUIRE(bus.hello(1, "scheduler") == "service_welcome");
  CHECK(bus.ask(1, ServiceAlive{100}) == "service_alive_seen");
  CHECK(bus.ant.bus.back().message.reply_to == 77);
}

TEST_CASE("what a router does not answer is Nacked to who asks, and to nobody who only tells or answers") {
  Bus bus;
  REQUIRE(bus.hello(1, "scheduler") == "service_welcome");
  CHECK(bus.ask(1, KeepAlive{1}) == "bad_value");
  Message word = make_message(MessageType::information, "ant", "ant", KeepAlive{1});
  const auto say = [&] {
    const std::size_t before = bus.ant.bus.size();
    Effects effects;
    bus.ant.core->forwarding().on_bus_message(1, word, bus.fleet.now, effects);
    bus.fleet.carry_out(bus.ant, effects);
    return bus.ant.bus.size() - before;
  };
  CHECK(say() == 0);
  word.type = MessageType::request;
  word.reply_to = 5;
  CHECK(say() == 0);
  CHECK(bus.ant.count("refused.bad_value") == 3);
}

TEST_CASE("the end of a service is written down, that of a probe is not") {
  Bus bus;
  const auto ends = [&] {
    return std::count_if(bus.ant.log.begin(), bus.ant.log.end(),
                         [](const std::string& line) { return line.starts_with("service_gone"); });
  };
  bus.hello(1, "trb", {}, true);
  bus.hello(2, "scheduler");
  bus.gone(1);
  CHECK(ends() == 0);
  bus.gone(2);
  CHECK(ends() == 1);
  bus.gone(2);
  CHECK(ends() == 1);
}

TEST_CASE("a probe that was silent for a lease is still one; a moment later it is forgotten") {
  Bus bus;
  bus.hello(1, "trb", {}, true);
  bus.fleet.run(Seconds(10));
  bus.hello(2, "trb", {}, true);
  CHECK(bus.ant.told(HelloWanted::kSubtype) == 0);
  bus.fleet.run(kStep);
  bus.hello(3, "trb", {}, true);
  CHECK(bus.ant.told(HelloWanted::kSubtype) == 1);
  CHECK_FALSE(bus.ant.core->bus().knows(1));
}

TEST_CASE("the table of services has one row each, and calls silent who said nothing for over three seconds") {
  Bus bus;
  bus.hello(1, "scheduler");
  bus.hello(9, "trb", {}, true);
  const auto row = [&](std::size_t at) {
    REQUIRE(bus.ask(9, ServiceListRequest{}) == "service_table");
    const auto table = decode<ServiceTable>(bus.ant.bus.back().message.data);
    CHECK(table->services.size() == bus.ant.core->config().services.size());
    return table->services.at(at);
  };
  bus.fleet.run(Seconds(3));
  CHECK(row(0).service == "router");
  CHECK(row(1).service == "mode-adapter");
  CHECK(row(1).state == "down");
  CHECK(row(2).service == "scheduler");
  CHECK(row(2).state == "up");
  bus.fleet.run(kStep);
  CHECK(row(2).state == "silent");
  bus.ask(1, ServiceAlive{100});
  CHECK(row(2).state == "up");
}
