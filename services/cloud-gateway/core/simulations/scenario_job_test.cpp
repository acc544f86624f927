// A scenario as a job of a simulation: with the fleet's own robots, checked, and its waits.
#include "services/cloud-gateway/core/simulations/scenario_job.hpp"

#include <doctest/doctest.h>

#include "common/scenario/definition.hpp"
#include "proto/body.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

NodeProfile profile(const std::string& robot) {
  NodeProfile out;
  out.robot = robot;
  SkillInfo skill;
  skill.name = "go_to";
  out.skills = {skill};
  return out;
}

/// A cloud, a robot that is there, and one that is not reached.
KnownNodes hall() {
  return {{"arm", profile("OFFLINE")}, {"cart", profile("ONLINE")}, {"cloud", NodeProfile{}}};
}

const char* const kRight = R"({"protocol": "talkrobots", "seed": 3, "scenario": {"name": "short", "tasks": [
  {"id": "go", "robot": "cart", "skill": "go_to"},
  {"id": "back", "robot": "arm", "skill": "go_to", "after": ["go"]}]}})";

ConfigFaults faults_of(const std::string& text, const KnownNodes& nodes) {
  ConfigFaults out;
  check_simulation_job(*parse_json(text), robots_of(nodes), out);
  REQUIRE(out.empty());
  scenario_job(*parse_json(text), nodes, out);
  return out;
}

std::string with_task(const std::string& task) {
  return R"({"protocol": "talkrobots", "scenario": {"name": "n", "tasks": [)" + task + "]}}";
}

}  // namespace

TEST_CASE("the gateway puts its robots in, and a list has no scenario") {
  ConfigFaults faults;
  const SimulationJob job = scenario_job(*parse_json(kRight), hall(), faults);
  REQUIRE(faults.empty());
  CHECK(job.robots == 2);
  CHECK(job.tasks == 2);
  CHECK(*parse_json(job.text) == *parse_json(kRight));
  CHECK(job.outline == R"({"protocol":"talkrobots","seed":3})");
  const Value input = *parse_json(job.input);
  CHECK(*input.find("scenario") == *parse_json(kRight)->find("scenario"));
  const Value::List& fleet = input.find("fleet")->list();
  REQUIRE(fleet.size() == 2);
  CHECK(fleet[0].find("id")->text() == "arm");
  CHECK(fleet[1].find("id")->text() == "cart");
  const auto read = from_json<NodeProfile>(dump_json(*fleet[1].find("profile")));
  REQUIRE(read.ok());
  CHECK(*read == profile("ONLINE"));
  CHECK(simulation_in_words(job) == "scenario 'short', 2 robots, 2 tasks");
}

TEST_CASE("a scenario's fault is named by its place in the job") {
  struct Case {
    std::string task;
    const char* key;
  };
  for (const Case& one :
       {Case{R"({"id": "go", "robot": "nobody", "skill": "go_to"})", "scenario.tasks[0].robot"},
        Case{R"({"id": "go", "robot": "cart", "skill": "fly"})", "scenario.tasks[0].skill"},
        Case{R"({"id": "Go", "robot": "cart", "skill": "go_to"})", "scenario.tasks[0].id"},
        Case{R"({"id": "go", "robot": "cart", "skill": "go_to", "after": ["x"]})", "scenario.tasks[0].after"},
        Case{R"(7)", "scenario.tasks[0]"}}) {
    CAPTURE(one.task);
    const ConfigFaults faults = faults_of(with_task(one.task), hall());
    REQUIRE_FALSE(faults.empty());
    CHECK(faults[0].key.starts_with(one.key));
    CHECK_FALSE(faults[0].hint.empty());
  }
}

TEST_CASE("a condition needs a sensor of the job, in its unit") {
  const auto waiting = [](const std::string& sensors) {
    return R"({"protocol": "talkrobots", "scenario": {"name": "n", "tasks": [{"id": "go", "robot": "cart", "skill": "go_to",
        "when": {"sensor": "t", "of": "cart", "op": ">", "value": 20, "unit": "degC"}}]}, "sensor_values": [)" +
           sensors + "]}";
  };
  CHECK(faults_of(waiting(R"({"node": "cart", "name": "t", "unit": "degC", "value": 21})"), hall()).empty());
  const ConfigFaults none = faults_of(waiting(""), hall());
  REQUIRE(none.size() == 1);
  CHECK(none[0].key == "scenario");
  CHECK(none[0].hint.find("sensor_values") != std::string::npos);
  CHECK_FALSE(faults_of(waiting(R"({"node": "cart", "name": "t", "unit": "K", "value": 300})"), hall()).empty());
  CHECK_FALSE(faults_of(waiting(R"({"node": "arm", "name": "t", "unit": "degC", "value": 21})"), hall()).empty());
}

TEST_CASE("a condition may be on a sensor of the cloud, whatever the fleet's own is called") {
  KnownNodes nodes = hall();
  nodes.erase("cloud");
  nodes["hub"] = {};
  const auto waiting = [](const std::string& of, const std::string& node) {
    return R"({"protocol": "talkrobots", "scenario": {"name": "n", "tasks": [{"id": "go", "robot": "cart", "skill": "go_to",
        "when": {"sensor": "t", "of": ")" +
           of + R"(", "op": ">", "value": 20, "unit": "degC"}}]}, "sensor_values": [{"node": ")" + node +
           R"(", "name": "t", "unit": "degC", "value": 21}]})";
  };
  CHECK(faults_of(waiting("cloud", "cloud"), nodes).empty());
  const ConfigFaults own = faults_of(waiting("hub", "cloud"), nodes);
  REQUIRE(own.size() == 1);
  CHECK(own[0].key == "scenario.tasks[0].when.of");
  CHECK(own[0].hint.find(R"("of": "cloud")") != std::string::npos);
  CHECK(faults_of(waiting("cloud", "cart"), nodes).size() == 1);
}

TEST_CASE("a time that no task of the scenario has is named") {
  const auto with_times = [](const std::string& times) {
    return R"({"protocol": "talkrobots", "scenario": {"name": "n", "tasks": [
        {"id": "go", "robot": "cart", "skill": "go_to"}]}, "times": )" +
           times + "}";
  };
  CHECK(faults_of(with_times(R"({"go_to": 3, "task:go": 2})"), hall()).empty());
  const ConfigFaults wrong = faults_of(with_times(R"({"goto": 3})"), hall());
  REQUIRE(wrong.size() == 1);
  CHECK(wrong[0].key == "times.goto");
  CHECK(wrong[0].hint.find("go_to") != std::string::npos);
  // A task's skill that nobody has is told first, and alone.
  const ConfigFaults first = faults_of(R"({"protocol": "talkrobots", "scenario": {"name": "n", "tasks": [
      {"id": "go", "robot": "cart", "skill": "goto"}]}, "times": {"go_to": 3}})",
                                       hall());
  REQUIRE(first.size() == 1);
  CHECK(first[0].key == "scenario.tasks[0].skill");
}

namespace {

std::string scenario_text(const std::string& name, std::size_t tasks) {
  std::string out;
  for (std::size_t i = 0; i < tasks; ++i) {
    out += (i == 0 ? "" : ", ") + (R"({"id": "t)" + std::to_string(i) + R"(", "robot": "cart", "skill": "go_to"})");
  }
  return R"({"name": ")" + name + R"(", "tasks": [)" + out + "]}";
}

std::string with_beside(const std::string& beside, const std::string& more = "") {
  return R"({"protocol": "talkrobots", "scenario": )" + scenario_text("one", 1) + R"(, "beside": [)" + beside + "]" +
         more + "}";
}

}  // namespace

TEST_CASE("scenarios beside the first one are played with it, and each alone; a list has none of them") {
  const std::string text = with_beside(R"({"scenario": )" + scenario_text("two", 3) +
                                       R"(, "after": 20}, {"scenario": )" + scenario_text("three", 1) + "}");
  ConfigFaults faults;
  const SimulationJob job = scenario_job(*parse_json(text), hall(), faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  REQUIRE(job.scenarios.size() == 3);
  CHECK(job.scenarios[2].name == "three");
  CHECK(job.tasks == 5);
  CHECK(*parse_json(job.text) == *parse_json(text));
  CHECK(job.outline == R"({"protocol":"talkrobots"})");
  const Value input = *parse_json(job.input);
  CHECK(*input.find("beside") == *parse_json(text)->find("beside"));
  CHECK(input.find("alone")->boolean());
  CHECK(parse_json(scenario_job(*parse_json(kRight), hall(), faults).input)->find("alone") == nullptr);
  CHECK(simulation_in_words(job) == "scenario 'one' and 2 beside it, 2 robots, 5 tasks");
}

TEST_CASE("what is wrong with a scenario beside the first one is named by its place") {
  const std::string good = R"({"scenario": )" + scenario_text("two", 1) + "}, ";
  struct Case {
    std::string task;
    const char* key;
  };
  for (const Case& one :
       {Case{R"({"id": "go", "robot": "nobody", "skill": "go_to"})", "beside[1].scenario.tasks[0].robot"},
        Case{R"({"id": "go", "robot": "cart", "skill": "fly"})", "beside[1].scenario.tasks[0].skill"},
        Case{R"({"id": "go", "robot": "cart", "skill": "go_to", "when": {"sensor": "t", "of": "cart", "op": ">",
                 "value": 20, "unit": "degC"}})",
             "beside[1].scenario"},
        Case{R"(7)", "beside[1].scenario.tasks[0]"}}) {
    CAPTURE(one.task);
    const ConfigFaults faults =
        faults_of(with_beside(good + R"({"scenario": {"name": "n", "tasks": [)" + one.task + "]}}"), hall());
    REQUIRE_FALSE(faults.empty());
    CHECK(faults[0].key.starts_with(one.key));
    CHECK_FALSE(faults[0].hint.empty());
  }
}

TEST_CASE("the scenarios of a job have no more tasks in all than a counted job") {
  const ConfigFaults faults = faults_of(with_beside(R"({"scenario": )" + scenario_text("two", 1000) + "}"), hall());
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].key == "beside");
  CHECK(faults[0].what == "the scenarios have 1001 tasks in all");
  CHECK(faults_of(with_beside(R"({"scenario": )" + scenario_text("two", 999) + "}"), hall()).empty());
}

TEST_CASE("a time is of all scenarios that have its skill or task; one that none has is named") {
  const std::string two = R"({"scenario": )" + scenario_text("two", 2) + "}";
  CHECK(faults_of(with_beside(two, R"(, "times": {"go_to": 2, "task:t1": 4})"), hall()).empty());
  const ConfigFaults wrong = faults_of(with_beside(two, R"(, "times": {"task:t2": 4})"), hall());
  REQUIRE(wrong.size() == 1);
  CHECK(wrong[0].key == "times.task:t2");
}

TEST_CASE("the answer has the waits of every run") {
  ConfigFaults faults;
  const Scenario scenario = read_scenario(*parse_json(scenario_text("one", 1)), "scenario", faults);
  const Value answer = *parse_json(with_waits(R"({"world": {"submitted_s": 1},
      "tasks": [{"id": "t0", "robot": "cart", "begin_s": 1, "end_s": 4}],
      "beside": [{"submitted_s": 1, "tasks": [{"id": "t0", "robot": "cart", "begin_s": 4, "end_s": 7}]}]})",
                                              {scenario, scenario}));
  CHECK(answer.find("waits")->list()[0].find("kept_s") == nullptr);
  const Value::List& waits = answer.find("beside")->list()[0].find("waits")->list();
  REQUIRE(waits.size() == 1);
  CHECK(waits[0].find("waited_for_run")->integer() == 0);
  CHECK(waits[0].find("kept_s")->number() == doctest::Approx(3));
}

TEST_CASE("what is no scenario is refused") {
  for (const char* text : {"7", "[]", "null", "{}", R"({"name": "n"})", R"({"name": "n", "tasks": []})"}) {
    CAPTURE(text);
    const ConfigFaults faults =
        faults_of(R"({"protocol": "talkrobots", "scenario": )" + std::string(text) + "}", hall());
    REQUIRE_FALSE(faults.empty());
    CHECK(faults[0].key.starts_with("scenario"));
  }
}

TEST_CASE("no robot is known, or more than can be simulated, or more than fits") {
  REQUIRE(faults_of(kRight, {{"cloud", NodeProfile{}}}).size() == 1);
  KnownNodes many = hall();
  for (int i = 0; i < 99; ++i) many["r" + std::to_string(i)] = profile("ONLINE");
  REQUIRE(faults_of(kRight, many).size() == 1);
  CHECK(faults_of(kRight, many)[0].what == "the fleet has 101 robots");
  KnownNodes large = hall();
  for (int i = 0; i < 60; ++i) {
    NodeProfile& one = large["r" + std::to_string(i)] = profile("ONLINE");
    for (int k = 0; k < 300; ++k) one.places.push_back(std::to_string(k) + std::string(60, 'p'));
  }
  const ConfigFaults faults = faults_of(kRight, large);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].key == "scenario");
}

TEST_CASE("the answer has what each task waited for; what is none stays as it is") {
  ConfigFaults faults;
  const Scenario scenario = read_scenario(*parse_json(kRight)->find("scenario"), "scenario", faults);
  REQUIRE(faults.empty());
  const Value answer = *parse_json(with_waits(R"({"seconds": 9, "tasks": [
      {"id": "go", "robot": "cart", "begin_s": 1, "end_s": 4},
      {"id": "back", "robot": "arm", "begin_s": 4.1, "end_s": 7}]})",
                                              {scenario}));
  CHECK(answer.find("seconds")->integer() == 9);
  const Value::List& waits = answer.find("waits")->list();
  REQUIRE(waits.size() == 2);
  CHECK(waits[0].find("waited_for")->text().empty());
  CHECK(waits[1].find("waited_for")->text() == "go");
  CHECK(waits[1].find("critical")->boolean());
  CHECK(with_waits("no JSON", {scenario}) == "no JSON");
  CHECK(with_waits("[]", {scenario}) == "[]");
}
