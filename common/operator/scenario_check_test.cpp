#include "common/operator/scenario_check.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

constexpr const char* kScenario = R"({"name":"n","tasks":[
  {"id":"t1","robot":"cart1","skill":"go_to","data":{"place":"dock"}}]})";

}  // namespace

TEST_CASE("a scenario's text is read with every fault, also if it is no JSON") {
  ConfigFaults faults;
  CHECK(parse_scenario(kScenario, "s.json", faults).tasks.size() == 1);
  CHECK(faults.empty());
  parse_scenario("{", "s.json", faults);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].file == "s.json");
}

TEST_CASE("the robot of a node that is not reached is as far away as its node") {
  const RouteTable table{"ant", {cart("cart1"), cart("cart2", "OFFLINE")}};
  CHECK(profiles_of(table).at("cart1").robot == "ONLINE");
  CHECK(profiles_of(table).at("cart2").robot == "OFFLINE");
}

TEST_CASE("a sensor of a node that is not reached is no rival of one that is there") {
  RouteTable table{"ant", {cart("cart1"), cart("cart2", "OFFLINE")}};
  for (Route& route : table.routes)
    route.profile.plugged = {{"oven", "temperature", "degC", "SN1", "", SensorState::ok, ""}};
  CHECK(profiles_of(table).at("cart1").plugged[0].state == SensorState::ok);
  CHECK(profiles_of(table).at("cart2").plugged[0].state == SensorState::unread);
  constexpr const char* kWaits = R"({"name":"n","tasks":[{"id":"t1","robot":"cart1","skill":"go_to",
    "data":{"place":"dock"},"when":{"sensor":"temperature","identity":"SN1","op":">","value":20,"unit":"degC"}}]})";
  FakeNode node;
  Ending<ScenarioCheck> check;
  ConfigFaults none;
  check_with_fleet(node.session(), parse_scenario(kWaits, "s.json", none), "s.json", {}, check);
  REQUIRE(none.empty());
  node.take<RouteListRequest>();
  SUBCASE("which is offline") {
    node.answer(table);
    CHECK(check.value().faults.empty());
  }
  SUBCASE("and one is that is there as well") {
    table.routes[1].state = "ONLINE";
    node.answer(table);
    REQUIRE(check.value().faults.size() == 1);
    CHECK(check.value().faults[0].key.ends_with(".of"));
  }
}

TEST_CASE("with a fleet, the check tells faults, or which tasks nobody else could take over") {
  FakeNode node;
  Ending<ScenarioCheck> check;
  ConfigFaults none;
  check_with_fleet(node.session(), parse_scenario(kScenario, "s.json", none), "s.json", {}, check);
  node.take<RouteListRequest>();
  SUBCASE("a spare is there") {
    node.answer(RouteTable{"ant", {cart("cart1"), cart("cart2")}});
    CHECK(check.value().faults.empty());
    CHECK(check.value().without_spare.empty());
  }
  SUBCASE("there is none") {
    node.answer(RouteTable{"ant", {cart("cart1")}});
    REQUIRE(check.value().without_spare.size() == 1);
    CHECK(check.value().without_spare[0].task == "t1");
  }
  SUBCASE("the robot is unknown") {
    node.answer(RouteTable{"ant", {cart("cart2")}});
    CHECK(faults_that_stop(check.value().faults).size() == 1);
    CHECK(check.value().without_spare.empty());
  }
  SUBCASE("the router has just started") {
    node.answer(RouteTable{"ant", {cart("cart2")}, false, "", true});
    CHECK(check.error().code == Errc::peer_unreachable);
  }
  SUBCASE("the router says nothing") {
    node.pass(kAnswerWait);
    CHECK(check.error().code == Errc::timeout);
  }
}

TEST_CASE("the fleet's faults are told with those of the file, but none that only follow from these") {
  constexpr const char* kTypos = R"({"name":"n","tasks":[
    {"id":"t1","robot":"carrt1","skill":"go_to","data":{"place":"dock"},"after":["aa"]},
    {"id":"t2","robot":"cart1","skil":"go_to"},
    {"id":"t3","robot":"cart1","skill":"goto"}]})";
  FakeNode node;
  Ending<ScenarioCheck> check;
  ConfigFaults faults;
  const Scenario scenario = parse_scenario(kTypos, "s.json", faults);
  REQUIRE(faults.size() == 3);  // "aa", "skil", and that there is no skill
  check_with_fleet(node.session(), scenario, "s.json", faults, check);
  node.take<RouteListRequest>();
  node.answer(RouteTable{"ant", {cart("cart1")}});
  const ConfigFaults& told = check.value().faults;
  REQUIRE(told.size() == 5);
  CHECK(told[3].key == "tasks[0].robot");
  CHECK(told[4].key == "tasks[2].skill");
  CHECK(check.value().without_spare.empty());
}
