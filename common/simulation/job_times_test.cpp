#include "common/simulation/job_times.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::simulation;

namespace {

struct Read {
  SkillTime usual;
  std::map<std::string, SkillTime> times;
  ConfigFaults faults;
};

Read read(const std::string& text) {
  Read out;
  const auto json = parse_json(text);
  REQUIRE(json.ok());
  ObjectReader reader(*json, "", FileFaults("job", out.faults));
  out.usual = read_usual_time(reader);
  out.times = read_times(reader);
  reader.refuse_unknown_keys();
  return out;
}

}  // namespace

TEST_CASE("a time is seconds, or a mean with a deviation") {
  const Read some =
      read(R"({"task_seconds": 4, "deviation": 1, "times": {"go": 5, "task:t": {"mean": 2, "deviation": 1}}})");
  CHECK(some.faults.empty());
  CHECK(some.usual.mean_s == 4);
  CHECK(some.usual.deviation_s == 1);
  CHECK(some.times.at("go").mean_s == 5);
  CHECK(some.times.at("task:t").deviation_s == 1);
  CHECK(read("{}").usual.mean_s == 3);
}

TEST_CASE("what is wrong with a time is named") {
  struct Case {
    const char* text;
    const char* key;
  };
  for (const Case& one :
       {Case{R"({"task_seconds": 0})", "task_seconds"}, Case{R"({"deviation": 4})", "deviation"},
        Case{R"({"task_seconds": 2, "deviation": 3})", "deviation"}, Case{R"({"times": [3]})", "times"},
        Case{R"({"times": {"go": "3"}})", "times.go"}, Case{R"({"times": {"go": 0}})", "times.go"},
        Case{R"({"times": {"go": {}}})", "times.go.mean"},
        Case{R"({"times": {"go": {"mean": 1, "deviation": 2}}})", "times.go.deviation"}}) {
    CAPTURE(one.text);
    const ConfigFaults faults = read(one.text).faults;
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].key == one.key);
    CHECK_FALSE(faults[0].hint.empty());
  }
}

TEST_CASE("a time that nothing has is told, with what was probably meant") {
  Scenario scenario;
  for (const char* id : {"there", "back"}) {
    Task& task = scenario.tasks.emplace_back();
    task.id = id;
    task.skill = "go_to";
  }
  const auto found = [&](const std::string& times) {
    ConfigFaults out;
    check_times(read(R"({"times": )" + times + "}").times, scenario, FileFaults("job", out));
    return out;
  };
  CHECK(found(R"({"go_to": 5, "task:there": 2, "task:back": 3})").empty());
  const ConfigFaults wrong = found(R"({"goto": 5, "task:bakc": 2, "there": 3, "swim": 4})");
  REQUIRE(wrong.size() == 4);
  CHECK(wrong[0].key == "times.goto");
  CHECK(wrong[0].hint.find("'go_to'") != std::string::npos);
  CHECK(wrong[1].key == "times.swim");
  CHECK(wrong[1].hint.find("go_to") != std::string::npos);
  CHECK(wrong[2].key == "times.task:bakc");
  CHECK(wrong[2].hint.find("'task:back'") != std::string::npos);
  CHECK(wrong[3].key == "times.there");
}

TEST_CASE("a task whose value another one takes needs a result: without one the run would stop there") {
  Scenario scenario;
  for (const char* id : {"find", "fetch"}) {
    Task& task = scenario.tasks.emplace_back();
    task.id = id;
    task.skill = std::string(id) + "_box";
  }
  scenario.tasks[1].values.push_back({"place", "find", ""});
  const auto found = [&](const std::string& times) {
    const Read job = read(R"({"times": )" + times + "}");
    ConfigFaults out = job.faults;
    check_times(job.times, scenario, FileFaults("job", out));
    return out;
  };
  CHECK(found(R"({"task:find": {"mean": 2, "result": "left"}})").empty());
  CHECK(found(R"({"find_box": {"mean": 2, "result": {"place": [1, 2]}}})").empty());
  for (const char* none : {"{}", R"({"find_box": 2})", R"({"find_box": {"mean": 2, "result": 1}, "task:find": 2})"}) {
    CAPTURE(none);
    const ConfigFaults faults = found(none);
    REQUIRE(faults.size() == 1);
    CHECK(faults[0].key == "times.task:find.result");
    CHECK(faults[0].what == "is missing: task 'fetch' takes a value from 'find'");
    CHECK(faults[0].hint.find(R"("task:find": {"mean": 3, "result": ...})") != std::string::npos);
  }
  const std::string long_text(1100, 'x');
  CHECK(found(R"({"find_box": {"mean": 2, "result": ")" + long_text + "\"}}").front().key == "times.find_box.result");
}

TEST_CASE("a time is of a scenario that has its skill, or the task that it names") {
  Scenario scenario;
  scenario.tasks.emplace_back().id = "find";
  scenario.tasks.back().skill = "look";
  for (const char* name : {"look", "task:find"}) CHECK(is_time_of(name, scenario));
  for (const char* name : {"find", "task:look", "task:", ""}) CHECK_FALSE(is_time_of(name, scenario));
}
