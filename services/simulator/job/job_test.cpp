#include "services/simulator/job/job.hpp"

#include <doctest/doctest.h>

#include "services/simulator/counting/play.hpp"
#include "services/simulator/job/answer.hpp"
#include "services/simulator/job/world_job.hpp"

using namespace trb;
using namespace trb::simulator;

TEST_CASE("a job with everything becomes a plan, and its answer has every phase") {
  ConfigFaults faults;
  const Job job = read_job(
      R"({"robots": 5, "tasks": 9, "interpreted": 5, "sensors": 1, "seconds": 180, "remote_requests": 1, "faulty": 1})",
      faults);
  REQUIRE(faults.empty());
  counting::Tally tally(180);
  const double seconds = counting::play(job.plan, tally);
  CHECK(seconds == 180);
  const Value answer = answer_value(tally, seconds);
  CHECK(answer.find("messages")->integer() == 299);
  CHECK(answer.find("phases")->find("fail")->find("messages")->integer() == 2);
  CHECK(answer.find("phases")->object().size() == 8);
  CHECK(answer.find("over_time")->find("messages")->list().size() == 181);
}

TEST_CASE("every fault of a job is named, with a hint") {
  struct Case {
    const char* text;
    const char* key;
  };
  for (
      const Case& one : {
          Case{R"({"tasks": 9})", "robots"},
          Case{R"({"robots": 0, "tasks": 9})", "robots"},
          Case{R"({"robots": 5, "tasks": 1e7})", "tasks"},
          Case{R"({"robots": 5, "tasks": 9, "interpreted": 6})", "interpreted"},
          Case{R"({"robots": 5, "tasks": 9, "task_seconds": 0})", "task_seconds"},
          Case{R"({"robots": 5, "tasks": 9, "rate": -1})", "rate"},
          Case{R"({"robots": 5, "tasks": 9, "local_requests": 1})", "sensors"},
          Case{R"({"robots": 1, "tasks": 9, "sensors": 1, "remote_requests": 1})", "remote_requests"},
          Case{R"({"robots": 5, "tasks": 9, "faulty": 5})", "faulty"},
          Case{R"({"robots": 5, "tasks": 9, "sensors": 100000, "rate": 1000, "seconds": 100000})", "sensors"},
          Case{R"({"robots": 5, "tasks": 9, "robot": 3})", "robot"},
          Case{R"({"robots": 5, "tasks": 9, "protocol": "mqtt"})", "protocol"},
          Case{R"({"protocol": "talkrobots", "robots": 1001, "tasks": 9})", "robots"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "link": "string"})", "link"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "seed": -1})", "seed"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "sensors": 1})", "sensors"},
          Case{
              R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": [{"at": 1, "kind": "burn", "node": "r0"}]})",
              "faults[0].kind"},
          Case{
              R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": [{"at": 1, "kind": "kill", "node": "r5"}]})",
              "faults.node"},
          Case{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": [{"kind": "kill", "node": "r1"}]})",
               "faults[0].at"},
      }) {
    CAPTURE(one.text);
    ConfigFaults faults;
    read_job(one.text, faults);
    REQUIRE_FALSE(faults.empty());
    CHECK(faults[0].key == one.key);
    CHECK_FALSE(faults[0].hint.empty());
  }
  ConfigFaults faults;
  read_job("{", faults);
  CHECK(faults.size() == 1);
}

TEST_CASE("a job for the real cores becomes a world, and its answer says what became of the run") {
  ConfigFaults faults;
  const Job job = read_job(
      R"({"protocol": "talkrobots", "robots": 2, "tasks": 3, "link": "wifi", "seed": 4,
          "faults": [{"at": 2, "kind": "cut", "node": "r1", "other": "cloud"}, {"at": 4, "kind": "heal", "node": "r1"}]})",
      faults);
  REQUIRE(faults.empty());
  REQUIRE(job.world);
  CHECK(job.world->link.name == "wifi");
  CHECK(job.world->faults.size() == 2);
  world::World world(*job.world);
  const Value answer = world_value(world.play());
  CHECK(answer.find("state")->text() == "FINISHED");
  CHECK(answer.find("tasks_done")->integer() == 3);
  CHECK(answer.find("broken")->list().empty());
}

TEST_CASE("a line of a trace names both ends") {
  const Value line = trace_value({.at_s = 3,
                                  .phase = CostPhase::forward,
                                  .from = {counting::Party::middleware, 2},
                                  .to = {counting::Party::cloud, 0},
                                  .bytes = 52});
  CHECK(dump_json(line) == R"({"at_s":3.0,"phase":"forward","from":"middleware 2","to":"cloud","bytes":52})");
}
