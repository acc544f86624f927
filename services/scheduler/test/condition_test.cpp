// Tasks that depend on a sensor's value: what is asked, waited for, chosen and skipped.
#include "services/scheduler/test/condition_story.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

TEST_CASE("by 20 degC the UR picks left or right, and the reading that decided is kept") {
  for (const bool warm : {false, true}) {
    CAPTURE(warm);
    Story story;
    FakeSensor& sensor = story.fleet["conveyor"].sensors.plug("temperature", {warm ? 25.1 : 15});
    story.submit(left_or_right());
    CHECK(story.seen("left").condition == "temperature of conveyor <= 20 degC");
    REQUIRE(story.finishes());
    story.check_one_branch();
    CHECK(sensor.asked == 1);
    const TaskView skipped = story.seen(warm ? "left" : "right");
    CHECK(skipped.state == TaskState::skipped);
    CHECK(skipped.reason == (warm ? "temperature of conveyor was 25.1 degC, not <= 20"
                                  : "temperature of conveyor was 15 degC, not > 20"));
    CHECK(story.seen(warm ? "right" : "left").state == TaskState::finished);
    CHECK(story.seen("right").condition ==
          (warm ? "temperature of conveyor was 25.1 degC, > 20" : "temperature of conveyor was 15 degC, not > 20"));
    // Those who were only told of it show it alike.
    CHECK(story.seen(warm ? "left" : "right", "pioneer").state == TaskState::skipped);
    CHECK(story.fleet.carried["baton"] == 3);  // as without conditions
  }
}

TEST_CASE("the sensor is found in a router's table that comes page by page, also if some are lost") {
  for (const unsigned loss : {0U, 200U}) {
    Story story;
    story.fleet.page = 1;
    story.fleet.weather.local_loss = loss;
    FakeSensor& sensor = story.fleet["conveyor"].sensors.plug("temperature", {25.1});
    story.submit(left_or_right());
    REQUIRE(story.finishes());
    CHECK(sensor.asked >= 1);
    story.check_one_branch();
  }
}

TEST_CASE("the skipped result carries the reading") {
  Story story;
  story.fleet["conveyor"].sensors.plug("temperature", {25.1});
  story.submit(left_or_right());
  REQUIRE(story.finishes());
  for (const JournalRecord& record : story.fleet["cloud"].journal) {
    const auto* kept = get_if<JournalResult>(&record);
    if (kept == nullptr) continue;
    const auto result = decode<TaskResult>(kept->result.payload.bytes);
    if (result->outcome != TaskOutcome::skipped) continue;
    CHECK(result->key.task == "left");
    CHECK(result->robot == "ur3");
    CHECK(from_json<SensorReading>(result->data)->number == 25.1);
    return;
  }
  FAIL("no skipped result");
}

TEST_CASE("a sensor that cannot be reached is waited for, in words, and asked every 5 s at most") {
  Story story;
  FakeSensor& sensor = story.fleet["conveyor"].sensors.plug("temperature", {25});
  story.fleet["conveyor"].cut = true;
  story.submit(left_or_right());
  REQUIRE(story.waits("temperature of conveyor: 'conveyor' cannot be reached", "ridgeback"));
  REQUIRE(story.waits("temperature of conveyor: 'conveyor' cannot be reached", "cloud"));
  story.fleet.pass(seconds(30));
  const int before = story.fleet.carried["sensor_read"];
  story.fleet.pass(seconds(60));
  CHECK(story.fleet.carried["sensor_read"] - before <= 13);
  CHECK(story.fleet.carried["sensor_read"] - before >= 10);
  CHECK(sensor.asked == 0);
  CHECK(story.begun() == std::map<std::string, int>{{"bring", 1}});
  story.fleet["conveyor"].cut = false;
  const auto chosen = [](const TaskView& task) { return task.condition.find(" was ") != std::string::npos; };
  REQUIRE(story.fleet.until([&] { return std::ranges::any_of(story.view().tasks, chosen); }));
  CHECK(story.view().state == RunState::running);
  CHECK(story.view().waits_for.empty());
  REQUIRE(story.finishes());
  story.check_one_branch();
  CHECK(story.view().waits_for.empty());
}

TEST_CASE("a sensor-bus that hangs is asked again, and its late answer is one") {
  Story story;
  story.fleet["conveyor"].sensors.plug("temperature", {25});
  story.fleet["conveyor"].sensors.hangs = true;
  story.submit(left_or_right());
  REQUIRE(story.waits("temperature of conveyor: 'conveyor' does not answer"));
  const SensorReading late{"temperature", "", "degC", false, 10, "", 1, 7, "good", 0, 0};
  const Outbox out = story.fleet.tell("ridgeback", "conveyor", MessageType::information, late, 77);
  REQUIRE(sent<SignRequest>(out).size() == 1);
  CHECK(sent<SignRequest>(out)[0].kind == kSignedChoice);
}

TEST_CASE("what is stale, doubted or of another unit is not believed") {
  Story story;
  FakeSensor& sensor = story.fleet["conveyor"].sensors.plug("temperature", {19, 19, 19, 25});
  sensor.values[0].quality = "stale";
  sensor.values[1].quality = "bad";
  sensor.values[2].unit = "K";
  story.submit(left_or_right());
  REQUIRE(story.waits("temperature of conveyor: its value is 'stale'"));
  REQUIRE(story.waits("temperature of conveyor: its value is 'bad'"));
  REQUIRE(story.waits("temperature of conveyor: its unit is 'K', not 'degC'"));
  REQUIRE(story.finishes());
  CHECK(sensor.asked == 4);
  CHECK(story.seen("right").state == TaskState::finished);
}

TEST_CASE("a sensor that is not there may be plugged in later") {
  Story story;
  story.submit(left_or_right());
  REQUIRE(story.waits("temperature of conveyor: no such sensor is plugged in"));
  story.fleet["conveyor"].sensors.plug("temperature", {15});
  REQUIRE(story.finishes());
  CHECK(story.seen("left").state == TaskState::finished);
}

TEST_CASE("without `of` a node is chosen whose sensor is well, then the smallest id; a serial number is followed") {
  Story story;
  story.fleet["conveyor"].sensors.plug("temperature", {15}).info.state = SensorState::failed;
  FakeSensor& chosen = story.fleet["drone"].sensors.plug("inside", {25}, "28-01");
  story.fleet["pioneer"].sensors.plug("temperature", {15});
  Scenario scenario = left_or_right();
  for (std::size_t i = 1; i <= 2; ++i) scenario.tasks[i].when[0].of = "";
  SUBCASE("any") {
    story.submit(scenario);
    REQUIRE(story.finishes());
    CHECK(chosen.asked == 1);
    CHECK(story.seen("right").condition == "inside of drone was 25 degC, > 20");
  }
  SUBCASE("serial number, on another node than is named") {
    for (std::size_t i = 1; i <= 2; ++i) {
      scenario.tasks[i].when[0].of = "conveyor";
      scenario.tasks[i].when[0].identity = "28-02";
    }
    story.submit(scenario);
    REQUIRE(story.waits("temperature with serial number 28-02: no such sensor is plugged in"));
    story.fleet["pioneer"].sensors.plug("temperature", {30}, "28-02");
    REQUIRE(story.finishes());
    CHECK(story.seen("left").reason == "temperature of pioneer was 30 degC, not <= 20");
  }
  SUBCASE("serial number, on the node that is named: another's claim to it counts for nothing") {
    for (std::size_t i = 1; i <= 2; ++i) {
      scenario.tasks[i].when[0].of = "pioneer";
      scenario.tasks[i].when[0].identity = "28-02";
    }
    story.fleet["conveyor"].sensors.plug("elsewhere", {15}, "28-02");
    story.fleet["pioneer"].sensors.plug("temperature", {30}, "28-02");
    story.submit(scenario);
    REQUIRE(story.finishes());
    CHECK(story.seen("left").reason == "temperature of pioneer was 30 degC, not <= 20");
  }
}

TEST_CASE("a task without predecessors is chosen on by its own actor when it could start") {
  Story story;
  story.fleet["conveyor"].sensors.plug("temperature", {25});
  Scenario scenario;
  scenario.tasks = {when(task("cool", "ur3", {}), Comparison::less, 20), task("after", "drone", {0})};
  story.submit(scenario);
  REQUIRE(story.finishes());
  CHECK(story.seen("cool").state == TaskState::skipped);
  CHECK(story.seen("after").reason == "every task before it was skipped");
  CHECK(story.begun().empty());
}

TEST_CASE("what follows only skipped tasks is skipped, its own condition unasked; a join goes on") {
  Story story;
  FakeSensor& sensor = story.fleet["conveyor"].sensors.plug("temperature", {25});
  Scenario scenario;
  scenario.tasks = {task("a", "ridgeback", {}),     when(task("b", "ur3", {0}), Comparison::less, 20),
                    task("c", "drone", {1}),        when(task("d", "pioneer", {2}), Comparison::less, 20, "nobody"),
                    task("e", "ur3", {3}),          task("f", "conveyor", {0}),
                    task("g", "ridgeback", {4, 5}), task("h", "drone", {3, 4})};
  story.submit(scenario);
  REQUIRE(story.finishes());
  CHECK(story.begun() == std::map<std::string, int>{{"a", 1}, {"f", 1}, {"g", 1}});
  CHECK(sensor.asked == 1);
  CHECK(story.seen("d").condition == "temperature of nobody < 20 degC");
  CHECK(story.seen("h").reason == "every task before it was skipped");
}

TEST_CASE("a join's condition is read when all before it is final, by the actor of the lowest-numbered of them") {
  Story story;
  FakeSensor& sensor = story.fleet["conveyor"].sensors.plug("temperature", {25});
  Scenario scenario;
  scenario.tasks = {task("slow", "drone", {}), task("quick", "ur3", {}),
                    when(task("join", "pioneer", {1, 0}), Comparison::more, 20)};
  story.fleet["ur3"].adapter.skill_time = seconds(30);
  story.submit(scenario);
  story.fleet.pass(seconds(20));
  CHECK(sensor.asked == 0);
  REQUIRE(story.finishes());
  CHECK(sensor.asked == 1);
  CHECK(story.begun()["join"] == 1);
  const auto chose = [&](const char* node) {
    const auto& journal = story.fleet[node].journal;
    return std::any_of(journal.begin(), journal.end(),
                       [](const JournalRecord& record) { return holds_alternative<JournalChoice>(record); });
  };
  CHECK(chose("drone"));
  CHECK(chose("pioneer"));
  CHECK_FALSE(chose("ur3"));
}

TEST_CASE("a tag's text decides, too") {
  Story story;
  FakeSensor& reader = story.fleet["conveyor"].sensors.plug("tag", {0});
  reader.values[0] = {"tag", "", "", true, 0, "04a1", 1, 0, "good", 0, 0};
  Scenario scenario = left_or_right();
  scenario.tasks[1].when = {{"tag", "", "", Comparison::equal, true, 0, "04a1", ""}};
  scenario.tasks[2].when = {{"tag", "", "", Comparison::unequal, true, 0, "04a1", ""}};
  story.submit(scenario);
  REQUIRE(story.finishes());
  CHECK(story.seen("right").reason == "tag of conveyor was '04a1', not != '04a1'");
  CHECK(story.seen("left").state == TaskState::finished);
}

TEST_CASE("abort and expiry end the waiting") {
  Story story;
  story.submit(left_or_right(), "cloud", seconds(60));
  REQUIRE(story.waits("temperature of conveyor: no such sensor is plugged in"));
  SUBCASE("abort") {
    story.fleet.ask("cloud", MessageType::command, RunAbort{story.fleet.sign_order("cloud", kRun)});
    REQUIRE(story.fleet.until([&] { return story.view().state == RunState::aborted; }, seconds(10)));
  }
  SUBCASE("expiry") {
    story.fleet.pass(seconds(70));
  }
  FakeSensor& sensor = story.fleet["conveyor"].sensors.plug("temperature", {15});
  story.fleet.pass(seconds(60));
  CHECK(sensor.asked == 0);
  CHECK(story.begun() == std::map<std::string, int>{{"bring", 1}});
}

TEST_CASE("a skipped task does not wait for its robot") {
  Story story;
  story.fleet["conveyor"].sensors.plug("temperature", {25});
  story.fleet["ur3"].adapter.set(false, true);
  story.submit(left_or_right("ur3", "drone"));
  REQUIRE(story.finishes());
  CHECK(story.fleet["ur3"].adapter.commanded.empty());
}
