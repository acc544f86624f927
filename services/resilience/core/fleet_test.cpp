#include "services/resilience/core/fleet.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "services/resilience/core/robot_state.hpp"
#include "services/resilience/test/fleet_fixture.hpp"

using namespace trb;
using namespace trb::resilience;

namespace {

Ids who_can_drive(const Fleet& fleet) {
  return find_candidates(fleet, {{drive("dock")}, {}}).robots;
}

Ids kinds(const Fleet& fleet) {
  Ids out;
  for (const HistoryEntry& entry : fleet.changes().history) out.push_back(entry.kind);
  return out;
}

}  // namespace

TEST_CASE("a robot joins, fails, is mended, goes and comes back: it is a candidate while it can") {
  Fleet fleet;
  REQUIRE(fleet.on_joined("pioneer1", at_second(0)));
  CHECK(who_can_drive(fleet).empty());
  REQUIRE(tell_profile(fleet, "pioneer1", mobile_robot(), at_second(1)));
  CHECK(who_can_drive(fleet) == Ids{"pioneer1"});

  CHECK(fleet.on_fault("pioneer1", {"mobile", Severity::urgent, "a bumper"}, at_second(2)));
  CHECK(who_can_drive(fleet) == Ids{"pioneer1"});
  CHECK(fleet.on_fault("pioneer1", {"mobile", Severity::critical, "a wheel is off"}, at_second(3)));
  CHECK(who_can_drive(fleet).empty());
  CHECK(fleet.end_faults("pioneer1", "mobile", "mended, says the operator", at_second(4)));
  CHECK_FALSE(fleet.end_faults("pioneer1", "mobile", "again", at_second(4)));
  CHECK(who_can_drive(fleet) == Ids{"pioneer1"});

  fleet.on_expired("pioneer1", "lease", at_second(5));
  CHECK(who_can_drive(fleet).empty());
  REQUIRE(fleet.on_joined("pioneer1", at_second(6)));
  CHECK(who_can_drive(fleet) == Ids{"pioneer1"});
  CHECK(kinds(fleet) == Ids{"joined", "connection", "profile", "fault", "fault", "fault_ended", "expired", "joined"});
}

TEST_CASE("a fault that comes before its node's profile is not lost") {
  Fleet fleet;
  REQUIRE(fleet.on_fault("ridgeback", {"mobile", Severity::critical, "motor"}, at_second(1)));
  CHECK(who_can_drive(fleet).empty());
  REQUIRE(fleet.on_route(route_of("ridgeback", carrier()), at_second(2)));
  CHECK(who_can_drive(fleet).empty());
  CHECK(find_candidates(fleet, {{load()}, {}}).robots == Ids{"ridgeback"});
}

TEST_CASE("a fault takes one capability: a Ridgeback that cannot move can still load") {
  Fleet fleet;
  REQUIRE(fleet.on_route(route_of("ridgeback", carrier()), at_second(0)));
  fleet.on_fault("ridgeback", {"mobile", Severity::critical, "motor"}, at_second(1));
  CHECK(who_can_drive(fleet).empty());
  CHECK(find_candidates(fleet, {{load()}, {}}).robots == Ids{"ridgeback"});
  fleet.on_fault("ridgeback", {"", Severity::fatal, "emergency stop"}, at_second(2));
  CHECK(find_candidates(fleet, {{load()}, {}}).robots.empty());
  // The end of one fault is not the end of the other.
  fleet.end_faults("ridgeback", "", "released", at_second(3));
  CHECK(find_candidates(fleet, {{load()}, {}}).robots == Ids{"ridgeback"});
  CHECK(who_can_drive(fleet).empty());
}

TEST_CASE("who is off, stopped, behind a broken connection or without a route is no candidate, and it is said why") {
  Fleet fleet;
  NodeProfile stopped = mobile_robot();
  stopped.fenced = true;
  NodeProfile off = mobile_robot();
  off.robot = "OFFLINE";
  off.detail = "no route to host";
  REQUIRE(fleet.on_route(route_of("a", mobile_robot(), "self"), at_second(0)));
  REQUIRE(fleet.on_route(route_of("b", stopped), at_second(0)));
  REQUIRE(fleet.on_route(route_of("c", off), at_second(0)));
  REQUIRE(fleet.on_route(route_of("d", mobile_robot(), "CONNECTION_BROKEN"), at_second(0)));
  REQUIRE(fleet.on_route(route_of("e", mobile_robot()), at_second(0)));
  REQUIRE(fleet.on_route(route_of("cloud", NodeProfile{}, "self"), at_second(0)));
  CHECK(fleet.on_connection("e", {"CONNECTION_BROKEN", "cable"}, at_second(1)));
  const Candidates found = find_candidates(fleet, {{drive("dock")}, {}});
  CHECK(found.robots == Ids{"a"});
  CHECK(why(found, "b") == "is stopped until it is released");
  CHECK(why(found, "c") == "is OFFLINE: no route to host");
  CHECK(why(found, "d") == "its node is not reached");
  CHECK(why(found, "e") == "is CONNECTION_BROKEN: cable");
  CHECK(found.others == 1);
}

TEST_CASE("a node that has not told of its robot yet ends no fault, and brings no retired robot back") {
  NodeProfile told = mobile_robot();
  told.out_of_use = {{"mobile", Severity::critical, "a wheel is off", 1, false, ""},
                     {"", Severity::warning, "maintenance", 1, true, "ann"}};
  Fleet fleet;
  REQUIRE(fleet.on_route(route_of("a", told), at_second(0)));
  REQUIRE(fleet.on_route(route_of("a", NodeProfile{}), at_second(1)));  // its router has begun anew
  CHECK(fault_of(*fleet.find("a"), "mobile") != nullptr);
  CHECK(fleet.has_retired());
  REQUIRE(fleet.on_route(route_of("a", told), at_second(2)));
  const Ids said = kinds(fleet);
  CHECK(std::count(said.begin(), said.end(), "fault") == 1);
  CHECK(std::count(said.begin(), said.end(), "fault_ended") == 0);
  CHECK(std::count(said.begin(), said.end(), "retired") == 1);
  CHECK(std::count(said.begin(), said.end(), "returned") == 0);
  REQUIRE(fleet.on_route(route_of("a", mobile_robot()), at_second(3)));
  CHECK(fault_of(*fleet.find("a"), "mobile") == nullptr);
  CHECK_FALSE(fleet.has_retired());
}

TEST_CASE("a plugged sensor gives its kind as a capability while one of that kind works") {
  NodeProfile profile = mobile_robot();
  profile.capabilities.push_back("temperature");
  profile.plugged = {{"t1", "temperature", "degC", "7", "", SensorState::failed, "gone"}};
  Fleet fleet;
  const Needs warm{{{"measure", "", {"temperature"}, {}, {}}}, {}};
  REQUIRE(fleet.on_route(route_of("a", profile), at_second(0)));
  CHECK(find_candidates(fleet, warm).robots.empty());
  CHECK(why(find_candidates(fleet, warm), "a") == "'temperature': its sensor tells nothing (task measure)");
  profile.plugged.push_back({"t2", "temperature", "degC", "8", "", SensorState::ok, ""});
  REQUIRE(tell_profile(fleet, "a", profile, at_second(1)));
  CHECK(find_candidates(fleet, warm).robots == Ids{"a"});
}

TEST_CASE("values are kept with the moment at which they were told, and measured in the index") {
  Fleet fleet;
  REQUIRE(fleet.on_route(route_of("a", mobile_robot()), at_second(0)));
  CHECK(fleet.on_state("a", {{{"battery", "0.8"}, {"position", "[1, 2]"}}}, at_second(5)));
  CHECK(fleet.on_value("a", "position", "[3, 4]", at_second(9)));
  CHECK(fleet.set_later_tasks("a", 3));
  CHECK(charge_of(*fleet.find("a")) == Reported<double>{80, at_second(5)});
  CHECK(position_of(*fleet.find("a")) == Reported<HallPoint>{{3, 4}, at_second(9)});
  const Measures& measures = fleet.index().measures(*fleet.index().find("a"));
  CHECK(measures.charge == 80);
  CHECK(measures.x == 3);
  CHECK(measures.y == 4);
  CHECK(measures.availability == 25);
  CHECK_FALSE(fleet.on_state("nobody", {{{"battery", "0.8"}}}, at_second(5)));
}

TEST_CASE("what is urgent is what the robot will not simply tell again") {
  Fleet fleet;
  REQUIRE(fleet.on_route(route_of("a", mobile_robot()), at_second(0)));
  CHECK(fleet.changes().urgent());
  fleet.written();
  CHECK(fleet.changes().empty());
  for (int i = 0; i < 100; ++i) fleet.on_state("a", {{{"battery", "0.8"}}}, at_second(i));
  CHECK(fleet.changes().robots.size() == 1);
  NodeProfile taken = mobile_robot();
  taken.control = "cloud";
  REQUIRE(tell_profile(fleet, "a", taken, at_second(100)));
  CHECK_FALSE(fleet.changes().urgent());
  REQUIRE(tell_profile(fleet, "a", mobile_robot(), at_second(100)));
  fleet.on_fault("a", {"mobile", Severity::warning, "low"}, at_second(101));
  CHECK(fleet.changes().urgent());
  fleet.written();
  REQUIRE(tell_profile(fleet, "a", mobile_robot(), at_second(102)));  // nothing new
  CHECK(fleet.changes().empty());
}

TEST_CASE("a fault that is told again is the same one, with the moment at which it began") {
  Fleet fleet;
  REQUIRE(fleet.on_route(route_of("a", mobile_robot()), at_second(0)));
  fleet.on_fault("a", {"mobile", Severity::critical, "motor at 90 degrees"}, at_second(1));
  fleet.on_fault("a", {"mobile", Severity::critical, "motor at 95 degrees"}, at_second(9));
  const auto& faults = fleet.find("a")->faults;
  REQUIRE(faults.size() == 1);
  CHECK(faults[0] == Fault{"mobile", Severity::critical, "motor at 95 degrees", at_second(1)});
}

TEST_CASE("a fault that is told again in the same words is nothing new: nothing is written") {
  Fleet fleet;
  REQUIRE(fleet.on_fault("a", {"mobile", Severity::critical, "motor"}, at_second(1)));
  fleet.written();
  for (int i = 0; i < 1000; ++i) CHECK(fleet.on_fault("a", {"mobile", Severity::critical, "motor"}, at_second(2)));
  CHECK(fleet.changes().empty());
  CHECK(fleet.on_fault("a", {"mobile", Severity::critical, "motor and gear"}, at_second(3)));
  CHECK(fleet.changes().history.size() == 1);
}

TEST_CASE("a robot whose texts change with every message has a share of what is written at once; others have theirs") {
  Fleet fleet;
  const auto fault = [&](const std::string& robot, const std::string& text, std::int64_t second) {
    fleet.on_fault(robot, {"mobile", Severity::critical, text}, at_second(second));
    const bool urgent = fleet.changes().urgent();
    if (urgent) fleet.written();
    return urgent;
  };
  int commits = 0;
  for (int i = 0; i < 1000; ++i) commits += fault("a", "motor at " + std::to_string(i), 1) ? 1 : 0;
  CHECK(commits <= WriteShare::kMost);
  CHECK(commits > 30);
  // What it told last is known, and is written with the values.
  CHECK(fleet.find("a")->faults[0].text == "motor at 999");
  CHECK(fleet.changes().robots.contains("a"));
  CHECK(fleet.changes().history.empty());
  CHECK(fault("b", "motor", 1));
  // Later it has a share again, and its history says what it lacks.
  fleet.on_fault("a", {"mobile", Severity::critical, "motor is off"}, at_second(10));
  REQUIRE(fleet.changes().history.size() == 1);
  CHECK(fleet.changes().history[0].text.starts_with("CRITICAL mobile: motor is off ("));
  CHECK(fleet.changes().history[0].text.ends_with(" lines before it are left out)"));
}

TEST_CASE("what people do with a robot that talks too much is in its history, and no robot has others' room by it") {
  Fleet fleet;
  const NodeProfile in_use = mobile_robot();
  NodeProfile retired = in_use;
  retired.out_of_use = {{"", Severity::warning, "maintenance", 1, true, "ann"}};
  REQUIRE(tell_profile(fleet, "a", in_use, at_second(0)));
  for (int i = 0; i < 1000; ++i)
    fleet.on_fault("a", {"mobile", Severity::critical, "motor at " + std::to_string(i)}, at_second(1));
  fleet.written();
  REQUIRE(tell_profile(fleet, "a", retired, at_second(1)));
  CHECK(fleet.changes().urgent());
  REQUIRE(fleet.changes().history.size() == 1);
  CHECK(fleet.changes().history[0] == HistoryEntry{at_second(1), "a", "retired", "maintenance (by ann)"});
  REQUIRE(tell_profile(fleet, "a", in_use, at_second(1)));
  REQUIRE(fleet.changes().history.size() == 2);
  CHECK(fleet.changes().history[1].kind == "returned");
  fleet.written();
  // Its node may say so a thousand times.
  for (int i = 0; i < 1000; ++i) REQUIRE(tell_profile(fleet, "a", i % 2 == 0 ? retired : in_use, at_second(1)));
  CHECK(fleet.changes().history.size() < WriteShare::kMost);
}

TEST_CASE("a clock that was put back gives no share anew, and takes none for ever") {
  WriteShare share;
  while (share.take(at_second(1000))) {
  }
  CHECK_FALSE(share.take(at_second(0)));
  CHECK_FALSE(share.take(at_second(2)));
  CHECK(share.take(at_second(3)));
  CHECK_FALSE(share.take(at_second(3)));
}

TEST_CASE("what comes from outside is bounded: names, values, faults, history, numbers that are none") {
  Fleet fleet;
  REQUIRE(fleet.on_route(route_of("a", mobile_robot()), at_second(0)));
  for (int i = 0; i < 100; ++i) fleet.on_value("a", "v" + std::to_string(i), "1", at_second(1));
  CHECK(fleet.find("a")->values.size() == kMaxValues);
  CHECK(fleet.on_value("a", "v1", "2", at_second(2)));
  CHECK_FALSE(fleet.on_value("a", "v1", std::string(2000, '1'), at_second(2)));
  CHECK_FALSE(fleet.on_value("a", std::string(65, 'v'), "2", at_second(2)));
  fleet.on_fault("a", {"mobile", Severity::fatal, std::string(5000, 'x')}, at_second(3));
  for (int i = 0; i < 2000; ++i) {
    fleet.on_fault("a", {"c" + std::to_string(i), Severity::warning, "low"}, at_second(4 + i));
  }
  CHECK(fleet.find("a")->faults.size() == kMaxFaults);
  CHECK(fault_of(*fleet.find("a"), "mobile") != nullptr);  // the severe one is among them
  CHECK(fault_of(*fleet.find("a"), "mobile")->text.size() == kMaxValueSize);
  CHECK(fleet.changes().history.size() < Fleet::kMaxPendingHistory);
  NodeProfile strange = mobile_robot();
  strange.frame.yaw = kUnknown;
  strange.skills[0].timeout_s = kUnknown;
  REQUIRE(tell_profile(fleet, "a", strange, at_second(3000)));
  fleet.written();
  REQUIRE(tell_profile(fleet, "a", strange, at_second(3001)));
  CHECK(fleet.changes().empty());
  CHECK_FALSE(fleet.on_joined("No Id", at_second(0)).ok());
}

TEST_CASE("while the disk fails, who has the most lines waiting loses its oldest") {
  Fleet fleet;
  REQUIRE(fleet.on_joined("quiet", at_second(0)));
  for (int i = 0; i < 2000; ++i) {
    const std::string id = i % 2 == 0 ? "a" : "b";
    REQUIRE(fleet.on_joined(id, at_second(10 * i)));
    fleet.on_expired(id, "lease", at_second(10 * i));
  }
  CHECK(fleet.changes().history.size() == Fleet::kMaxPendingHistory);
  CHECK(fleet.changes().history_dropped == 3001);
  CHECK(fleet.changes().history[0] == HistoryEntry{at_second(0), "quiet", "joined", ""});
  CHECK(fleet.changes().history.back().time == at_second(19'990));
}

TEST_CASE("the fleet is bounded too, and who has left makes room") {
  Fleet fleet;
  for (std::size_t i = 0; i < Fleet::kMaxRobots; ++i) {
    REQUIRE(fleet.on_joined("r" + std::to_string(i), at_second(0)));
  }
  const Status refused = fleet.on_joined("one-more", at_second(1));
  REQUIRE_FALSE(refused.ok());
  CHECK(refused.error().code == Errc::too_large);
  fleet.forget("r7", at_second(2));
  CHECK(fleet.on_joined("one-more", at_second(3)).ok());
  CHECK(fleet.find("r7") == nullptr);
}

TEST_CASE("a robot out of service that leaves the fleet for good is none that is out of service") {
  Fleet fleet;
  NodeProfile profile;
  profile.out_of_use = {{"", Severity::warning, "maintenance", 1, true, "ann"}};
  REQUIRE(tell_profile(fleet, "a", profile, at_second(0)));
  CHECK(fleet.has_retired());
  fleet.forget("a", at_second(1));
  CHECK_FALSE(fleet.has_retired());
}
