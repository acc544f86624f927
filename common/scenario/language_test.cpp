// What a scenario file may define: failures, results, rounds, and robots that are chosen late.
#include <doctest/doctest.h>

#include "common/scenario/definition.hpp"
#include "common/scenario/graph.hpp"
#include "proto/body.hpp"

using namespace trb;

namespace {

struct Read {
  Scenario scenario;
  ConfigFaults faults;
};

Read read(const std::string& tasks, const std::string& more = "") {
  const auto json = parse_json(R"({"name":"n",)" + more + R"("tasks":[)" + tasks + "]}");
  REQUIRE_MESSAGE(json.ok(), tasks);
  Read out;
  out.scenario = read_scenario(*json, "s.json", out.faults);
  for (const ConfigFault& fault : out.faults) CHECK_FALSE(fault.hint.empty());
  if (out.faults.empty()) CHECK(check_graph(out.scenario).ok());
  return out;
}

/// The only fault.
ConfigFault fault_of(const std::string& tasks, const std::string& more = "") {
  const Read r = read(tasks, more);
  REQUIRE_MESSAGE(r.faults.size() == 1, to_text(r.faults));
  return r.faults[0];
}

/// A task "carry" behind "scan", with these data.
std::string behind_scan(const std::string& data, const std::string& after = R"("scan")") {
  return R"({"id":"scan","robot":"r","skill":"look"},{"id":"count","robot":"r","skill":"look"},)"
         R"({"id":"carry","robot":"r","skill":"go","after":[)" +
         after + R"(],"data":)" + data + "}";
}

}  // namespace

TEST_CASE("a task says how often it is tried again, and what follows when that was no use") {
  const Task given = read(R"({"id":"a","robot":"r","skill":"go","retries":3,"retry_after_s":0.5,"on_failure":"skip"})")
                         .scenario.tasks.at(0);
  CHECK(given.retries == 3);
  CHECK(given.retry_after_s == 0.5);
  CHECK(given.on_failure == OnFailure::skip);
  const Task plain = read(R"({"id":"a","robot":"r","skill":"go"})").scenario.tasks.at(0);
  CHECK(plain.retries == 0);
  CHECK(plain.retry_after_s == 1);
  CHECK(plain.on_failure == OnFailure::resilience);
  CHECK(fault_of(R"({"id":"a","robot":"r","skill":"go","on_failure":"abrot"})").hint ==
        "use one of: resilience, skip, abort, continue; did you mean 'abort'?");
  CHECK(fault_of(R"({"id":"a","robot":"r","skill":"go","retires":3})").hint == "did you mean 'retries'?");
}

TEST_CASE("a task says how long it waits for its beginning, and that what follows goes on though it has failed") {
  const Task given =
      read(R"({"id":"a","robot":"r","skill":"go","on_failure":"continue","start_within_s":90.5})").scenario.tasks.at(0);
  CHECK(given.on_failure == OnFailure::continue_);
  CHECK(given.start_within_s == 90.5);
  Scenario scenario;
  scenario.tasks = {given};
  CHECK(decode<Scenario>(encode(scenario))->tasks.at(0) == given);
  for (const char* bad : {"0", "0.09", "86401", "-1", "\"soon\""}) {
    CHECK(fault_of(std::string(R"({"id":"a","robot":"r","skill":"go","start_within_s":)") + bad + "}").key ==
          "tasks[0].start_within_s");
  }
}

TEST_CASE("a task that is skipped when it fails takes with it what waits for it alone: told as a warning") {
  const auto warned = [](const std::string& film, const std::string& land) {
    ConfigFaults faults;
    const Read fly = read(R"({"id":"fly","robot":"d","skill":"go"},)"
                          R"({"id":"film","robot":"d","skill":"go","after":["fly"])" +
                          film + R"(},{"id":"land","robot":"d","skill":"go","after":)" + land + "}");
    warn_of_skips(fly.scenario, "s.json", faults);
    CHECK(faults_that_stop(faults).empty());
    return faults.empty() ? std::string() : faults[0].key + ": " + faults[0].what + "; " + faults[0].hint;
  };
  CHECK(
      warned(R"(,"on_failure":"skip")", R"(["film"])") ==
      "tasks[1].on_failure: task 'film' is skipped when it fails, and then 'land' too; say on_failure \"continue\" if "
      "that shall go on");
  CHECK(warned(R"(,"on_failure":"skip")", R"(["film","fly"])").empty());
  CHECK(warned(R"(,"on_failure":"continue")", R"(["film"])").empty());
  CHECK(warned("", R"(["film"])").empty());
}

TEST_CASE("a task may ask for capabilities in place of a robot, or of its robot and whoever replaces it") {
  const Task late = read(R"({"id":"a","skill":"go","requires":["mobile","carry"]})").scenario.tasks.at(0);
  CHECK(late.robot.empty());
  CHECK(late.requires_ == std::vector<std::string>{"mobile", "carry"});
  const Task both = read(R"({"id":"a","robot":"r","skill":"go","requires":["mobile"]})").scenario.tasks.at(0);
  CHECK(both.robot == "r");
  CHECK(both.requires_ == std::vector<std::string>{"mobile"});
}

TEST_CASE("a parameter may be taken from the result of a task before") {
  const Task task = read(behind_scan(R"({"to":{"from":"scan","value":"place"},"speed":1,"all":{"from":"scan"}})"))
                        .scenario.tasks.at(2);
  CHECK(task.data == R"({"speed":1})");
  CHECK(task.values == std::vector<ValueFrom>{{"to", "scan", "place"}, {"all", "scan", ""}});
  const Task none = read(behind_scan(R"({"to":{"x":1}})")).scenario.tasks.at(2);
  CHECK(none.values.empty());
  CHECK(none.data == R"({"to":{"x":1}})");
}

TEST_CASE("a value that cannot be there is told with what to do") {
  const ConfigFault later = fault_of(behind_scan(R"({"to":{"from":"count"}})"));
  CHECK(later.key == "tasks[2].data.to.from");
  CHECK(later.hint == R"(add "count" to its "after")");
  CHECK(fault_of(behind_scan(R"({"to":{"from":"carry"}})")).what == "is the task itself");
  CHECK(fault_of(behind_scan(R"({"to":{"from":"scn"}})")).hint == "did you mean 'scan'?");
  CHECK(fault_of(behind_scan(R"({"to":{"from":"scan","value":""}})")).key == "tasks[2].data.to.value");
  CHECK(fault_of(behind_scan(R"({"to":{"from":"scan","vale":"x"}})")).hint == "did you mean 'value'?");
  CHECK(fault_of(behind_scan(R"({"to":{"from":3}})")).key == "tasks[2].data.to.from");
  const Read misspelt = read(behind_scan(R"({"to":{"form":"scan","value":"x"}})"));
  REQUIRE(misspelt.faults.size() == 2);
  CHECK(misspelt.faults[1].hint == "did you mean 'from'?");
  std::string many;
  for (int i = 0; i < 33; ++i) many += (i == 0 ? "\"p" : ",\"p") + std::to_string(i) + R"(":{"from":"scan"})";
  CHECK(fault_of(behind_scan("{" + many + "}")).key == "tasks[2].data");
  CHECK(fault_of(behind_scan("{\"" + std::string(65, 'p') + R"(":{"from":"scan"}})")).what.find("65") !=
        std::string::npos);
}

TEST_CASE("rounds: ids, predecessors and values stay in their round, and the rounds in their order") {
  const std::string tasks = R"({"id":"a","robot":"r","skill":"go"},{"id":"b","robot":"r","skill":"go","after":["a"],)"
                            R"("data":{"p":{"from":"a"}}},{"id":"c","robot":"r","skill":"go","after":["a"]})";
  const Scenario twice = read(tasks, R"("repeat":2,)").scenario;
  REQUIRE(twice.tasks.size() == 6);
  CHECK(twice.tasks[3].id == "a#2");
  CHECK(twice.tasks[3].after == std::vector<std::uint16_t>{1, 2});
  CHECK(twice.tasks[4].id == "b#2");
  CHECK(twice.tasks[4].after == std::vector<std::uint16_t>{3});
  CHECK(twice.tasks[4].values == std::vector<ValueFrom>{{"p", "a#2", ""}});
  CHECK(twice.tasks[5].after == std::vector<std::uint16_t>{3});
  CHECK(read(tasks, R"("repeat":1,)").scenario == read(tasks).scenario);
  CHECK(read(tasks, R"("repeat":333,)").scenario.tasks.size() == 999);
}

TEST_CASE("rounds that are too many") {
  const std::string one = R"({"id":"a","robot":"r","skill":"go"})";
  const std::string three = one + R"(,{"id":"b","robot":"r","skill":"go"},{"id":"c","robot":"r","skill":"go"})";
  const ConfigFault over = fault_of(three, R"("repeat":334,)");
  CHECK(over.key == "repeat");
  CHECK(over.what == "makes 1002 tasks of 3");
  CHECK(over.hint == "use at most 333: a scenario has 1000 tasks at most");
  CHECK(fault_of(one, R"("repeat":0,)").key == "repeat");
  CHECK(fault_of(one, R"("repeat":1001,)").key == "repeat");
  CHECK(fault_of(one, R"("repeat":"2",)").key == "repeat");
  CHECK(fault_of(one, R"("repaet":2,)").hint == "did you mean 'repeat'?");
  const std::string longest = R"({"id":")" + std::string(62, 'a') + R"(","robot":"r","skill":"go"})";
  CHECK(read(longest, R"("repeat":9,)").faults.empty());
  const ConfigFault no_room = fault_of(longest, R"("repeat":10,)");
  CHECK(no_room.key == "tasks[0].id");
  CHECK(no_room.hint == "keep it to 61 bytes");
}

TEST_CASE("a scenario that no message could carry") {
  std::string tasks;
  for (int i = 0; i < 500; ++i) {
    tasks += (i == 0 ? "" : ",") + std::string(R"({"id":"t)") + std::to_string(i) + R"(","robot":"r","skill":"go"})";
  }
  CHECK(read(tasks).faults.empty());
  // Each of the second round's tasks would wait for each of the first's.
  const ConfigFault large = fault_of(tasks, R"("repeat":2,)");
  CHECK(large.key == "tasks");
  CHECK(large.hint.find("one task that waits for many") != std::string::npos);
}
