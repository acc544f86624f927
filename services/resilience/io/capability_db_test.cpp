// What the capability database keeps and returns after a restart.
#include "services/resilience/core/robot_state.hpp"
#include "services/resilience/test/db_folder.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

NodeProfile rich_profile() {
  NodeProfile profile = carrier();
  profile.maker = "Maker";
  profile.model = "Model";
  profile.sensors = {"battery", "t1"};
  profile.plugged = {{"t1", "temperature", "degC", "7", "device", SensorState::silent, "late"}};
  profile.capabilities.push_back("temperature");
  profile.control = "run 17";
  profile.detail = "fine";
  profile.frame = {1000, 1, 2, 0.5};
  profile.out_of_use = {{"carry", Severity::urgent, "weak", 5, false, "scheduler"}};
  profile.numbers = {{"payload", 2.5, "kg"}};
  return profile;
}

}  // namespace

TEST_CASE("that a robot is out of service, and a fault that its node has, are known after a restart") {
  const Folder folder;
  NodeProfile profile = mobile_robot();
  profile.out_of_use = {{"", Severity::warning, "new wheels", 6, true, "ann"},
                        {"mobile", Severity::critical, "wheel is off", 5, false, ""}};
  {
    const auto db = opened(folder);
    Fleet fleet;
    REQUIRE(fleet.on_route(route_of("pioneer1", profile), at_second(0)));
    CHECK(fleet.changes().urgent());
    REQUIRE(db->write(fleet, at_second(1)));
  }
  const auto db = opened(folder);
  Fleet fleet = loaded(*db);
  CHECK(fleet.find("pioneer1")->profile.is.out_of_use == profile.out_of_use);
  CHECK(fleet.find("pioneer1")->faults.size() == 1);
  // It was repaired meanwhile: the first profile shows it.
  profile.out_of_use.pop_back();
  REQUIRE(fleet.on_route(route_of("pioneer1", profile), at_second(10)));
  CHECK(fleet.find("pioneer1")->faults.empty());
  CHECK(why_unfit(*fleet.find("pioneer1")) == "is out of service: new wheels (by ann)");
}

TEST_CASE("after a restart everything is known again, but that its node is reached") {
  const Folder folder;
  {
    const auto db = opened(folder);
    Fleet fleet;
    REQUIRE(fleet.on_route(route_of("ridgeback", rich_profile()), at_second(0)));
    REQUIRE(fleet.on_route(route_of("pioneer1", mobile_robot()), at_second(1)));
    fleet.on_state("ridgeback", {{{"battery", "0.75"}, {"position", "[1000, 2000]"}}}, at_second(2));
    fleet.on_fault("ridgeback", {"mobile", Severity::critical, "motor"}, at_second(3));
    fleet.set_later_tasks("ridgeback", 2);
    REQUIRE(db->write(fleet, at_second(4)));
    CHECK(fleet.changes().empty());
  }
  const auto db = opened(folder);
  Fleet fleet = loaded(*db);
  CHECK(fleet.changes().empty());
  REQUIRE(fleet.robots().size() == 2);
  const RobotRecord& ridgeback = *fleet.find("ridgeback");
  CHECK(ridgeback.profile == Reported<NodeProfile>{rich_profile(), at_second(0)});
  CHECK(ridgeback.faults == std::vector<Fault>{{"mobile", Severity::critical, "motor", at_second(3)}});
  CHECK(ridgeback.later_tasks == 2);
  CHECK(charge_of(ridgeback) == Reported<double>{75, at_second(2)});
  CHECK(position_of(ridgeback).has_value());
  CHECK_FALSE(ridgeback.reached);
  CHECK(find_candidates(fleet, {{load()}, {}}).robots.empty());
  REQUIRE(fleet.on_joined("ridgeback", at_second(10)));
  REQUIRE(fleet.on_joined("pioneer1", at_second(10)));
  CHECK(find_candidates(fleet, {{load()}, {}}).robots == Ids{"ridgeback"});
  CHECK(find_candidates(fleet, {{drive("dock")}, {}}).robots == Ids{"pioneer1"});  // the fault is still there
}

TEST_CASE("what changes takes the place of what was: capabilities, faults that are over, robots that are gone") {
  KeptFleet kept;
  auto& [folder, db, fleet] = kept;
  kept.add("a", rich_profile());
  kept.add("b", rich_profile());
  fleet.on_fault("a", {"mobile", Severity::critical, "motor"}, at_second(1));
  fleet.on_value("a", "battery", "1", at_second(1));
  REQUIRE(db->write(fleet, at_second(1)));
  REQUIRE(tell_profile(fleet, "a", mobile_robot(), at_second(2)));
  fleet.end_faults("a", "mobile", "mended", at_second(2));
  fleet.forget("b", at_second(2));
  REQUIRE(db->write(fleet, at_second(2)));
  Fleet again = loaded(*db);
  REQUIRE(again.robots().size() == 1);
  CHECK(again.find("a")->profile.is == mobile_robot());
  CHECK(again.find("a")->faults.empty());
  CHECK(again.find("a")->values.size() == 1);
  // Forgotten and back before anything was written: nothing of its former record is left.
  fleet.forget("a", at_second(3));
  REQUIRE(fleet.on_joined("a", at_second(4)));
  REQUIRE(db->write(fleet, at_second(5)));
  Fleet third = loaded(*db);
  REQUIRE(third.robots().size() == 1);
  CHECK(third.find("a")->values.empty());
  CHECK(third.find("a")->profile.is == NodeProfile{});
}

TEST_CASE("who commands a robot is written without writing anew what it can do") {
  KeptFleet kept;
  auto& [folder, db, fleet] = kept;
  kept.add("a", rich_profile());
  REQUIRE(db->write(fleet, at_second(0)));
  NodeProfile taken = rich_profile();
  taken.control = "cloud";
  REQUIRE(tell_profile(fleet, "a", taken, at_second(1)));
  fleet.set_later_tasks("a", 4);
  CHECK(fleet.changes().robots.at("a") == Changes::kNode);
  REQUIRE(db->write(fleet, at_second(2)));
  Fleet again = loaded(*db);
  CHECK(again.find("a")->profile == Reported<NodeProfile>{taken, at_second(1)});
  CHECK(again.find("a")->later_tasks == 4);
}

TEST_CASE("the history is told newest first, of one or of all, and is bounded by number and age") {
  KeptFleet kept;
  auto& [folder, db, fleet] = kept;
  kept.add("a", mobile_robot());
  REQUIRE(fleet.on_joined("b", at_second(1)));
  REQUIRE(db->write(fleet, at_second(1)));
  const auto all = db->history("", 100);
  REQUIRE(all);
  REQUIRE(all->size() == 4);
  CHECK(all->front() == HistoryEntry{at_second(1), "b", "joined", ""});
  CHECK(db->history("a", 2)->size() == 2);
  for (int round = 0; round < 30; ++round) {
    for (int i = 0; i < 250; ++i) {
      fleet.on_expired("b", "lease", at_second(round * 2000 + 8 * i));
      REQUIRE(fleet.on_joined("b", at_second(round * 2000 + 8 * i)));
    }
    REQUIRE(db->write(fleet, at_second(round * 2000 + 2000)));
  }
  const auto kept_rows = static_cast<std::int64_t>(db->history("", 20'000)->size());
  CHECK(kept_rows <= CapabilityDb::kMaxHistory);
  CHECK(kept_rows >= CapabilityDb::kMaxHistory - CapabilityDb::kHistoryRoom);
  // However much one robot told: the other's are all there, and so are its own newest.
  CHECK(db->history("a", 100)->size() == 3);
  CHECK(db->history("b", 1)->front().time == at_second(29 * 2000 + 8 * 249));
  constexpr std::int64_t kMonth = 31LL * 24 * 3600;
  fleet.on_expired("b", "lease", at_second(kMonth + 60'000));
  REQUIRE(db->write(fleet, at_second(kMonth + 60'000)));
  CHECK(db->history("", 20'000)->size() == 1);
}

TEST_CASE("alerts and decisions: bytes in, the same bytes out, in a fixed order; a decision is never replaced") {
  const Folder folder;
  const Bytes bytes("\x00\xff body", 7);
  {
    const auto db = opened(folder);
    CHECK(db->put_alert({"b", at_second(1), 0, bytes}));
    CHECK(db->put_alert({"a", at_second(1), 0, ""}));
    CHECK(db->put_alert({"b", at_second(1), 2, bytes}));
    CHECK(db->put_decision({"run2", 2, bytes, false}));
    CHECK(db->put_decision({"run1", 3, bytes, false}));
    CHECK(db->put_decision({"run1", 2, bytes, false}));
    CHECK(db->put_decision({"run1", 2, bytes, false}));
    const Status other = db->put_decision({"run1", 2, "other", false});
    REQUIRE_FALSE(other.ok());
    CHECK(other.error().code == Errc::conflict);
    CHECK(db->set_delivered("run1", 2));
    CHECK(db->put_decision({"run1", 2, bytes, false}));  // stays delivered
    CHECK(db->drop_decisions("run2"));
  }
  const auto db = opened(folder);
  CHECK(*db->alerts() == std::vector<AlertRow>{{"a", at_second(1), 0, ""}, {"b", at_second(1), 2, bytes}});
  CHECK(*db->decisions() == std::vector<DecisionRow>{{"run1", 2, bytes, true}, {"run1", 3, bytes, false}});
}

TEST_CASE("a step is written whole or not at all") {
  const Folder folder;
  const auto db = opened(folder);
  CHECK(db->put_decision({"run1", 2, "first", false}));
  const Status step = db->transact([&]() -> Status {
    if (auto put = db->put_alert({"a", at_second(0), 1, "decided"}); !put) return put;
    return db->put_decision({"run1", 2, "second", false});
  });
  REQUIRE_FALSE(step.ok());
  CHECK(step.error().code == Errc::conflict);
  CHECK(db->alerts()->empty());
}

TEST_CASE("1,000 robots are there again after a restart, in one transaction and in the order of their ids") {
  const Folder folder;
  {
    const auto db = opened(folder);
    Fleet fleet;
    for (int i = 0; i < 1000; ++i) {
      REQUIRE(fleet.on_route(route_of("r" + std::to_string(i), i % 2 == 0 ? carrier() : mobile_robot()), at_second(i)));
    }
    REQUIRE(db->write(fleet, at_second(1000)));
  }
  const auto db = opened(folder);
  Fleet fleet = loaded(*db);
  CHECK(fleet.robots().size() == 1000);
  for (int i = 0; i < 1000; ++i) REQUIRE(fleet.on_joined("r" + std::to_string(i), at_second(2000)));
  CHECK(find_candidates(fleet, {{load()}, {}}).robots.size() == 500);
}
