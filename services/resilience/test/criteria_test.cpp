// The operator's own criteria: values of the robot, its description and sensors, bounds, and what a score means.
#include <doctest/doctest.h>

#include <algorithm>

#include "services/resilience/test/fixture.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

namespace {

ResilienceSettings settings_of(const std::string& criteria, ResilienceSettings base = default_resilience()) {
  const auto json = parse_json(R"({"criteria": )" + criteria + "}");
  REQUIRE(json.ok());
  ConfigFaults faults;
  ResilienceSettings read = read_resilience(*json, "resilience.json", faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  base.criteria = read.criteria;
  return base;
}

std::unique_ptr<Fixture> failed(const std::string& criteria, ResilienceSettings base = default_resilience()) {
  auto fixture = paper(settings_of(criteria, base));
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  return fixture;
}

SensorReading read(const std::string& sensor, double number, const std::string& quality = "good") {
  SensorReading out;
  out.sensor = sensor;
  out.number = number;
  out.quality = quality;
  return out;
}

SensorInfo plugged(const std::string& name, const std::string& kind) {
  return {name, kind, "degC", "", "", SensorState::ok, ""};
}

const CriterionPart& part(const Proposal& of, const std::string& criterion) {
  const auto at = std::ranges::find(of.parts, criterion, &CriterionPart::criterion);
  REQUIRE(at != of.parts.end());
  return *at;
}

}  // namespace

TEST_CASE("a merit is against the best that is possible: of five good ones the best has no less than alone") {
  auto fixture = std::make_unique<Fixture>();
  for (int i = 0; i < 5; ++i) fixture->add("r" + std::to_string(i), mobile_robot(), 95 - i, 4, 0.5);
  fixture->add("ridgeback", mobile_robot(), 70, 2, 0);
  fixture->add("turtlebot", mobile_robot(), 1, 4, 0);
  fixture->add("ur3", mobile_robot(), 1, 4, 90);
  fixture->begin_run();
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  const Alert many = fixture->alert();
  CHECK(many.proposals.size() == 7);
  CHECK(many.proposals[0].robot == "r0");
  CHECK(many.proposals[0].score < 0.3);
  CHECK(many.proposals[0].merit > 0.95);
  for (int i = 0; i < 5; ++i) fixture->silence("r" + std::to_string(i));
  fixture->silence("turtlebot");
  fixture->wait(seconds(12));
  for (const Alert& alert : fixture->alerts()) {
    if (alert.robot != "ridgeback") continue;
    REQUIRE(robots_of(alert) == Words{"ur3"});
    CHECK(alert.proposals[0].score == doctest::Approx(1));
    CHECK(alert.proposals[0].merit < 0.2);
  }
}

TEST_CASE("the policy's least score is one of merit: the only one, with 1 %, is not taken") {
  auto fixture = failed(R"({"battery": 1})", automatic(0.5));
  fixture->wait(seconds(10));
  CHECK(rulings(fixture->taken.at(0)) == "t4>turtlebot");
  fixture = paper(settings_of(R"({"battery": 1})", automatic(0.5)));
  for (const char* id : {"pioneer1", "turtlebot"}) fixture->silence(id);
  fixture->values["pioneer2"]["battery"] = "0.01";
  fixture->say("pioneer2", RobotState{{{"battery", "0.01"}}});
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(seconds(10));
  CHECK(fixture->taken.empty());
  for (const Alert& alert : fixture->alerts()) {
    if (alert.robot == "ridgeback") CHECK(alert.policy == "automatic, but asks: the best has a merit of 0.01");
  }
}

TEST_CASE("a number of the description counts, for tasks whose skills need that capability") {
  const std::string payload =
      R"({"battery": 1, "payload": {"weight": 3, "from": "description", "unit": "kg", "best": 10, "worst": 0,
          "capabilities": [")";
  auto fixture = paper(settings_of(payload + R"(mobile"]}})"));
  fixture->routes["pioneer2"].profile.numbers = {{"payload", 8, "kg"}};
  fixture->routes["pioneer1"].profile.numbers = {{"payload", 2, "kg"}};
  fixture->wait(seconds(40));
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  Alert alert = fixture->alert();
  CHECK(alert.proposals[0].robot == "pioneer2");
  CHECK(part(alert.proposals[0], "payload").value == 8);
  CHECK(part(alert.proposals[0], "payload").unit == "kg");
  CHECK(part(alert.proposals[0], "payload").weight == doctest::Approx(0.75));
  CHECK(part(alert.proposals[0], "payload").robot == "pioneer2");
  CHECK(alert.proposals[0].merit == doctest::Approx(0.75 * 0.8 + 0.25 * 0.55));
  for (const Proposal& one : alert.proposals) {
    if (one.robot == "turtlebot") CHECK(one.note.find("payload is not known") != std::string::npos);
  }
  fixture = failed(payload + R"(grab"]}})");
  alert = fixture->alert();
  CHECK(alert.proposals[0].robot == "turtlebot");  // its battery alone counts
  CHECK(alert.proposals[0].parts.size() == 3);
}

TEST_CASE("what the robot tells is asked for: a number, or an object that has it") {
  auto fixture = paper(settings_of(R"({"grip": {"from": "robot", "value": "grip_force", "best": 40, "worst": 0}})"));
  fixture->values["pioneer1"]["grip_force"] = "12.5";
  fixture->values["pioneer2"]["grip_force"] = R"({"grip_force": 30})";
  fixture->values["turtlebot"]["grip_force"] = R"(["much"])";
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  const Alert alert = fixture->alert();
  CHECK(fixture->heard["grip_force"] == 3);
  CHECK(alert.proposals[0].robot == "pioneer2");
  CHECK(part(alert.proposals[0], "grip").value == 30);
  CHECK(alert.proposals[0].merit == doctest::Approx(0.75));
  CHECK(alert.proposals.size() == 3);
}

TEST_CASE("what nobody knows of any robot is worth nothing, whatever is best") {
  const Alert alert = failed(R"({"heat": {"from": "robot", "best": 0, "worst": 100}})")->alert();
  REQUIRE(alert.proposals.size() == 3);
  CHECK(alert.proposals[0].merit == 0);
  CHECK(alert.proposals[0].note.find("heat is not known") != std::string::npos);
}

TEST_CASE("a sensor at the robot's node is read, by its name or its kind") {
  for (const char* word : {"t1", "temperature"}) {
    CAPTURE(word);
    auto fixture = paper(settings_of(R"({"heat": {"from": "sensor", "value": ")" + std::string(word) +
                                     R"(", "best": 20, "worst": 80, "at_most": 60}})"));
    for (const char* id : {"pioneer1", "pioneer2"}) {
      fixture->routes[id].profile.plugged = {plugged("t1", "temperature")};
    }
    fixture->wait(seconds(40));
    for (const auto& [id, value] : {std::pair{"pioneer1", 65.0}, std::pair{"pioneer2", -5.0}}) {
      fixture->readings[id][word] = read("t1", value);
    }
    fixture->end_task("t4", TaskOutcome::failed, "stuck");
    fixture->wait(seconds(1));
    const Alert alert = fixture->alert();
    REQUIRE(robots_of(alert) == Words{"pioneer2"});
    CHECK(alert.proposals[0].merit == doctest::Approx(1));
    CHECK(part(alert.proposals[0], "heat").value == -5);
    CHECK(why_unfit(alert, "pioneer1") == "heat 65, at most 60 wanted");
    CHECK(why_unfit(alert, "turtlebot") == "its heat is not known");  // it has no such sensor
  }
}

TEST_CASE("of two sensors of a kind the one that has the criterion's name is meant, as at its node") {
  auto fixture = paper(settings_of(R"({"inside": {"from": "sensor", "value": "temperature", "best": 20, "worst": 80},
                                      "outside": {"from": "sensor", "value": "temperature_2", "best": 20, "worst": 80}})"));
  fixture->routes["pioneer1"].profile.plugged = {plugged("temperature", "temperature"),
                                                 plugged("temperature_2", "temperature")};
  fixture->wait(seconds(40));
  fixture->readings["pioneer1"]["temperature"] = read("temperature", 25);
  fixture->readings["pioneer1"]["temperature_2"] = read("temperature_2", 70);
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  fixture->wait(seconds(1));
  const Alert alert = fixture->alert();
  REQUIRE(alert.proposals[0].robot == "pioneer1");
  CHECK(part(alert.proposals[0], "inside").value == 25);
  CHECK(part(alert.proposals[0], "outside").value == 70);
}

TEST_CASE("a reading that is not good is an answer, and leaves the value unknown") {
  SensorReading text = read("t1", 20);
  text.is_text = true;
  for (const SensorReading& doubtful : {read("t1", 20, "stale"), read("t1", 20, "bad"), text}) {
    CAPTURE(doubtful.quality);
    auto fixture = paper(settings_of(
        R"({"heat": {"from": "sensor", "value": "t1", "best": 20, "worst": 80, "at_most": 60}})", automatic()));
    fixture->readings["pioneer1"]["t1"] = read("t1", 30);
    fixture->readings["pioneer2"]["t1"] = doubtful;
    fixture->end_task("t4", TaskOutcome::failed, "stuck");
    fixture->wait(seconds(1));
    CHECK(why_unfit(fixture->alert(), "pioneer2") == "its heat is not known");
    fixture->wait(seconds(2));  // every robot has answered
    REQUIRE(fixture->taken.size() == 1);
    CHECK(rulings(fixture->taken[0]) == "t4>pioneer1");
  }
}

TEST_CASE("a refused reading ends the wait for that sensor alone; of an older node, which names none, for all") {
  for (const bool names_sensor : {true, false}) {
    CAPTURE(names_sensor);
    auto fixture = paper(settings_of(R"({"heat": {"from": "sensor", "value": "t1", "best": 20, "worst": 80},
                                        "damp": {"from": "sensor", "value": "h1", "best": 0, "worst": 100}})",
                                     automatic()));
    fixture->names_sensor = names_sensor;
    fixture->readings["turtlebot"]["h1"] = read("h1", 50);
    fixture->readings["pioneer1"]["h1"] = std::nullopt;
    fixture->end_task("t4", TaskOutcome::failed, "stuck");
    fixture->wait(seconds(3));
    CHECK(fixture->taken.empty() == names_sensor);
    if (!names_sensor) continue;
    CHECK(fixture->alert().policy == "automatic, waits: what pioneer1 answers");
    fixture->answer("pioneer1", read("h1", 10));
    fixture->wait(seconds(1));
    REQUIRE(fixture->taken.size() == 1);
    CHECK(rulings(fixture->taken[0]) == "t4>pioneer1");
  }
}

TEST_CASE("a bound keeps a robot out, with the reason; a person may override; who is charged is in again") {
  auto fixture = paper(settings_of(R"({"battery": {"at_least": 60}, "distance": 1})"));
  fixture->values["turtlebot"].clear();
  fixture->say("turtlebot", RobotState{{{"battery", "\"?\""}}});
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  Alert alert = fixture->alert();
  CHECK(robots_of(alert) == Words{"pioneer1"});
  CHECK(why_unfit(alert, "pioneer2") == "battery 55 %, at least 60 wanted");
  CHECK(why_unfit(alert, "turtlebot") == "its battery is not known");
  CHECK(fixture->decide(Verdict::accept, "pioneer2") == "bad_value");
  fixture->say("pioneer1", RobotState{{{"battery", "0.2"}}});
  fixture->values["pioneer1"]["battery"] = "0.2";
  fixture->values["pioneer2"]["battery"] = "0.9";
  fixture->wait(seconds(12));
  alert = fixture->alert();
  CHECK(robots_of(alert) == Words{"pioneer2"});
  CHECK(why_unfit(alert, "pioneer1") == "battery 20 %, at least 60 wanted");
  CHECK(fixture->decide(Verdict::override_, "pioneer1", false, "it is near its dock") == "accepted");
}

TEST_CASE("of a shared proposal each part names its robot, and they add up to the score") {
  auto fixture = paper();
  fixture->add("loader", loader_robot(), 40, 0, 0);
  fixture->fault("ridgeback", "");
  fixture->end_task("t4", TaskOutcome::failed);
  const Proposal shared = fixture->alert().proposals.at(0);
  CHECK(shared.robot.empty());
  double sum = 0;
  std::set<std::string> robots;
  for (const CriterionPart& one : shared.parts) {
    sum += one.contribution;
    robots.insert(one.robot);
  }
  CHECK(sum == doctest::Approx(shared.score));
  CHECK(robots == std::set<std::string>{"loader", "pioneer1"});
  CHECK(shared.merit > 0.5);
}

TEST_CASE("a bound for one of the tasks has several do them between them") {
  auto fixture = paper(settings_of(R"({"battery": 1, "payload": {"from": "description", "best": 10, "worst": 0,
                                     "at_least": 5, "capabilities": ["carry"]}})"));
  NodeProfile loader = loader_robot();
  loader.numbers = {{"payload", 7, "kg"}};
  fixture->add("husky", carrier(), 50, 0, 0);
  fixture->add("loader", loader, 50, 0, 0);
  for (const char* id : {"pioneer1", "pioneer2", "turtlebot"}) fixture->silence(id);
  fixture->fault("ridgeback", "");
  for (const Alert& alert : fixture->alerts()) {
    if (alert.robot != "ridgeback") continue;
    REQUIRE(robots_of(alert) == Words{""});
    CHECK(alert.proposals[0].tasks.back() == TaskForRobot{"t9", "loader"});
    CHECK(alert.proposals[0].tasks.front() == TaskForRobot{"t4", "husky"});
    CHECK(why_unfit(alert, "husky") == "its payload is not known");
  }
}

TEST_CASE("after a start what counts may be another: everybody is asked anew and proposed anew") {
  auto fixture = paper();
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  CHECK(fixture->alert().proposals[0].robot == "pioneer1");
  fixture->wait(seconds(20));
  fixture->settings.resilience = settings_of(R"({"battery": 1})");
  fixture->heard["position"] = 0;
  fixture->restart();
  fixture->wait(seconds(6));
  CHECK(robots_of(fixture->alert()) == Words{"turtlebot", "pioneer1", "pioneer2"});
  CHECK(fixture->heard["position"] >= 2);
}

TEST_CASE("of more robots than proposals the best by the operator's own criteria are told") {
  auto fixture =
      std::make_unique<Fixture>(settings_of(R"({"payload": {"from": "description", "best": 100, "worst": 0}})"));
  fixture->add("ridgeback", mobile_robot(), 70, 2, 0);
  fixture->add("ur3", mobile_robot(), 70, 2, 0);
  fixture->add("turtlebot", mobile_robot(), 70, 2, 0);
  for (int i = 0; i < 70; ++i) {
    NodeProfile profile = mobile_robot();
    profile.numbers = {{"payload", static_cast<double>(i), "kg"}};
    fixture->add("r" + std::to_string(100 + i), profile, 50, 0, 0);
  }
  fixture->begin_run();
  fixture->end_task("t4", TaskOutcome::failed, "stuck");
  const Alert alert = fixture->alert();
  REQUIRE(alert.proposals.size() == 64);
  CHECK(alert.proposals[0].robot == "r169");
  CHECK(alert.proposals[63].robot == "r106");
}

TEST_CASE("sixteen criteria of the operator's own are ranked by, though the paper's three are there beside them") {
  std::string own;
  for (int i = 0; i < 16; ++i) {
    own += (i == 0 ? "" : ", ") + std::string("\"own") + std::to_string(i) +
           R"(": {"from": "description", "best": 10, "worst": 0})";
  }
  const auto fixture = failed("{" + own + "}");
  const Body answer = fixture->ask(AlertRankRequest{fixture->alert().id, {}});
  REQUIRE(holds_alternative<AlertRanking>(answer));
  const AlertRanking in_force = get<AlertRanking>(answer);
  REQUIRE(in_force.weights.size() == kMaxRankedCriteria);
  CHECK(in_force.weights[0] == WeighedCriterion{"own0", 1.0 / 16});
  CHECK(in_force.proposals == fixture->alert().proposals);
  const Body other = fixture->ask(AlertRankRequest{fixture->alert().id, {{"battery", 1}, {"own15", 1}}});
  REQUIRE(holds_alternative<AlertRanking>(other));
  const std::vector<WeighedCriterion>& weights = get<AlertRanking>(other).weights;
  REQUIRE(weights.size() == kMaxRankedCriteria);
  CHECK(weights.front() == WeighedCriterion{"battery", 0.5});
  CHECK(weights.back() == WeighedCriterion{"own15", 0.5});
}
