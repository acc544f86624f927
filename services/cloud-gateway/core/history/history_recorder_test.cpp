// What of a robot's and a sensor's life is recorded, and how much of it.
#include "services/cloud-gateway/core/history/history_recorder.hpp"

#include <doctest/doctest.h>

#include "services/cloud-gateway/core/live/test/hall.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace trb::gateway::test;

namespace {

struct Recorded : Hall {
  HistoryRecorder recorder;
  Recorded() {
    book.observe(recorder);
    table({route("pioneer1")});
    recorder.take();
  }
  /// "fault base \"hot\"" of each entry since the last call.
  std::vector<std::string> entries() {
    recorder.tick(now);
    std::vector<std::string> lines;
    for (const HistoryEntry& one : recorder.take()) {
      std::string text(name_of(one.kind));
      for (const std::string* part : {&one.about, &one.value, &one.detail}) text += part->empty() ? "" : " " + *part;
      lines.push_back(std::move(text));
    }
    return lines;
  }
};

using Entries = std::vector<std::string>;

RobotFault fault_of(const std::string& text, bool ended = false) {
  RobotFault out;
  out.capability = "base";
  out.severity = Severity::critical;
  out.text = text;
  out.ended = ended;
  return out;
}

RunView view_of(TaskState state, const std::string& robot = "pioneer1") {
  RunView out;
  out.run = kRun;
  TaskView task;
  task.id = "t1";
  task.robot = robot;
  task.skill = "go_to";
  task.state = state;
  out.tasks = {task};
  return out;
}

}  // namespace

TEST_CASE("a robot's connection, its node's state, its faults and their ends are recorded as they come") {
  Recorded hall;
  hall.say("pioneer1", RobotConnection{"OFFLINE", "no answer"});
  CHECK(hall.entries() == Entries{"connection \"OFFLINE\" no answer"});
  hall.say("pioneer1", RobotConnection{"OFFLINE", "no answer"});
  CHECK(hall.entries().empty());
  hall.say("pioneer1", fault_of("motor is hot"));
  hall.say("pioneer1", fault_of("", true));
  CHECK(hall.entries() ==
        Entries{"fault base \"motor is hot\" CRITICAL", "fault_ended base \"motor is hot\" CRITICAL"});
  hall.say("cloud", PeerExpired{"pioneer1", "10 s unheard"});
  CHECK(hall.entries() == Entries{"node \"OFFLINE\" 10 s unheard"});
}

TEST_CASE("stop, control and what is out of use, with their ends") {
  Recorded hall;
  Route changed = route("pioneer1");
  changed.profile.fenced = true;
  changed.profile.control = "cloud";
  changed.profile.out_of_use = {{"carry", Severity::critical, "broken", 1, false, "olga"}};
  hall.table({changed});
  CHECK(hall.entries() == Entries{"fence true", "control \"cloud\"", "out_of_use carry \"broken\" olga"});
  hall.table({route("pioneer1")});
  CHECK(hall.entries() == Entries{"fence false", "control \"\"", "in_use carry \"broken\" olga"});
}

TEST_CASE("a value is recorded at once, then every 5 s at most: the newest one then") {
  Recorded hall;
  hall.tell("pioneer1", "battery", "80");
  CHECK(hall.entries() == Entries{"value battery 80"});
  for (const char* value : {"79", "78", "77"}) {
    hall.wait(seconds(1));
    hall.tell("pioneer1", "battery", value);
  }
  CHECK(hall.entries().empty());
  CHECK(hall.recorder.next_deadline());
  hall.wait(seconds(2));
  CHECK(hall.entries() == Entries{"value battery 77"});
  CHECK_FALSE(hall.recorder.next_deadline());
}

TEST_CASE("what is no JSON is a text, what is too long is cut") {
  Recorded hall;
  hall.tell("pioneer1", "word", "<b>\"");
  CHECK(hall.entries() == Entries{R"(value word "<b>\"")"});
  hall.tell("pioneer1", "list", "[1, 2]");
  CHECK(hall.entries() == Entries{"value list [1,2]"});
  hall.tell("pioneer1", "long", std::string(5000, 'x'));
  CHECK(hall.entries().at(0).size() < 1100);
}

TEST_CASE("a task is recorded with the robot that has it, also when it moves") {
  Recorded hall;
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  hall.say("cloud", view_of(TaskState::running));
  CHECK(hall.entries() == Entries{"task " + kRun + "/t1 \"RUNNING\" go_to"});
  hall.say("cloud", view_of(TaskState::waiting, "pioneer2"));
  hall.say("cloud", view_of(TaskState::finished, "pioneer2"));
  CHECK(hall.entries().size() == 2);
}

TEST_CASE("of a run that is over when it is first seen nothing is recorded again") {
  Recorded hall;
  hall.say("cloud", RunTable{{run(RunState::finished, 1)}});
  hall.say("cloud", view_of(TaskState::finished));
  CHECK(hall.entries().empty());
}

TEST_CASE("readings are recorded while somebody watches") {
  Recorded hall;
  Route with = route("pioneer1");
  SensorInfo sensor;
  sensor.name = "dht22";
  with.profile.plugged = {sensor};
  hall.table({with});
  hall.say("pioneer1", reading(21, 1));
  CHECK(hall.entries().empty());
  hall.watch("pioneer1", "dht22");
  SensorReading told = reading(21.5, 1);
  told.unit = "degC";
  told.quality = "good";
  hall.say("pioneer1", told);
  const auto entries = hall.recorder.take();
  REQUIRE(entries.size() == 1);
  CHECK(entries[0].sensor == "dht22");
  CHECK(entries[0].value == "21.5");
  CHECK(entries[0].about == "degC");
  CHECK(entries[0].detail == "good");
}

TEST_CASE("a batch is due half a second after its first entry") {
  Recorded hall;
  CHECK_FALSE(hall.recorder.next_deadline());
  hall.tell("pioneer1", "battery", "80");
  CHECK_FALSE(hall.recorder.is_due(hall.now));
  hall.wait(HistoryRecorder::kFlush);
  CHECK(hall.recorder.is_due(hall.now));
}

TEST_CASE(
    "a robot whose texts change with every message has its share; the rest is counted and told, and others' stay") {
  Recorded hall;
  hall.table({route("pioneer1"), route("pioneer2")});
  hall.wait(WriteShare::kEach);
  hall.recorder.take();
  constexpr int kWords = 1000;
  for (int i = 0; i < kWords; ++i) {
    hall.say("pioneer1", RobotConnection{"OFFLINE", std::to_string(i)});
    hall.say("pioneer1", fault_of(std::to_string(i)));
  }
  CHECK(hall.recorder.take().size() == WriteShare::kMost);
  const auto left_out = hall.recorder.take_left_out();
  CHECK(left_out.size() == 1);
  CHECK(left_out.at("pioneer1") == hall.recorder.lost());
  CHECK(hall.recorder.lost() > kWords);
  CHECK(hall.recorder.take_left_out().empty());
  hall.say("pioneer2", RobotConnection{"OFFLINE", "no answer"});
  hall.say("cloud", PeerExpired{"pioneer1", "10 s unheard"});
  CHECK(hall.entries() == Entries{"connection \"OFFLINE\" no answer", "node \"OFFLINE\" 10 s unheard"});
  hall.wait(WriteShare::kEach);
  hall.say("pioneer1", RobotConnection{"ONLINE", ""});
  CHECK(hall.entries() == Entries{"connection \"ONLINE\""});
}

TEST_CASE("tasks have a share of their own: a run that changes without end leaves its robots' states") {
  Recorded hall;
  hall.say("cloud", RunTable{{run(RunState::running, 1)}});
  for (int i = 0; i < 1000; ++i) hall.say("cloud", view_of(i % 2 == 0 ? TaskState::running : TaskState::waiting));
  CHECK(hall.recorder.take().size() == HistoryRecorder::kTasks);
  hall.say("pioneer1", RobotConnection{"OFFLINE", "no answer"});
  CHECK(hall.entries().size() == 1);
}

TEST_CASE("a sensor-bus that sends readings without end has its share") {
  Recorded hall;
  Row row;
  row.key = {RowKind::sensor, "pioneer1", "dht22"};
  constexpr int kMany = 10'000;
  for (int i = 0; i < kMany; ++i) {
    row.content = reading(i, static_cast<std::uint64_t>(i));
    hall.recorder.changed(row, {}, hall.now);
  }
  CHECK(hall.recorder.take().size() == HistoryRecorder::kReadings);
  CHECK(hall.recorder.lost() == kMany - HistoryRecorder::kReadings);
}

TEST_CASE("what waits is bounded, and whoever has most of it leaves room for the others") {
  Recorded hall;
  Route with = route("pioneer1");
  SensorInfo sensor;
  sensor.name = "dht22";
  with.profile.plugged = {sensor};
  hall.table({with, route("pioneer2")});
  hall.watch("pioneer1", "dht22");
  hall.recorder.take();
  Row row;
  row.key = {RowKind::sensor, "pioneer1", "dht22"};
  for (std::size_t i = 0; i < HistoryRecorder::kMaxWaiting; ++i) {
    row.content = reading(static_cast<double>(i), i);
    const Duration since = static_cast<std::int64_t>(i) * HistoryRecorder::kEachReading;
    hall.recorder.changed(row, {}, {hall.now.mono + since, hall.now.utc + since});
  }
  hall.say("pioneer2", RobotConnection{"OFFLINE", "no answer"});
  const auto waited = hall.recorder.take();
  CHECK(waited.size() == HistoryRecorder::kMaxWaiting / 2 + 1);
  CHECK(waited.back().node == "pioneer2");
  CHECK(hall.recorder.lost() == HistoryRecorder::kMaxWaiting / 2);
}

TEST_CASE("runs under way are looked at, large ones are not") {
  Hall hall;
  RunSummary large = run(RunState::running, 1, std::string(32, 'b'));
  large.tasks = 500;
  hall.say("cloud", RunTable{{run(RunState::running, 1), large, run(RunState::finished, 1, std::string(32, 'c'))}});
  CHECK(recorded_runs(hall.book) == std::set<std::string>{kRun});
}
