#include "services/simulator/job/job.hpp"

#include <doctest/doctest.h>

#include "services/simulator/counting/play.hpp"
#include "services/simulator/job/answer.hpp"
#include "services/simulator/job/model_answer.hpp"
#include "services/simulator/job/task_times.hpp"
#include "services/simulator/job/test/refused_job.hpp"
#include "services/simulator/job/world_job.hpp"

using namespace trb;
using namespace trb::simulator;
using namespace trb::simulator::test;

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

TEST_CASE("what was sent over time ends with the run, whatever it might have taken") {
  counting::Tally tally(1000);
  tally.add(9.5, CostPhase::task, 50, true);
  const Value over_time = *answer_value(tally, 9.8).find("over_time");
  for (const char* const key : {"messages", "bytes"}) CHECK(over_time.find(key)->list().size() == 10);
  CHECK(over_time.find("messages")->list().back().integer() == 1);
}

TEST_CASE("every fault of a job is named, with a hint") {
  for (
      const Wrong& one : {
          Wrong{R"({"tasks": 9})", "robots"},
          Wrong{R"({"robots": 0, "tasks": 9})", "robots"},
          Wrong{R"({"robots": 5, "tasks": 1e7})", "tasks"},
          Wrong{R"({"robots": 5, "tasks": 9, "interpreted": 6})", "interpreted"},
          Wrong{R"({"robots": 5, "tasks": 9, "task_seconds": 0})", "task_seconds"},
          Wrong{R"({"robots": 5, "tasks": 9, "rate": -1})", "rate"},
          Wrong{R"({"robots": 5, "tasks": 9, "local_requests": 1})", "sensors"},
          Wrong{R"({"robots": 1, "tasks": 9, "sensors": 1, "remote_requests": 1})", "remote_requests"},
          Wrong{R"({"robots": 5, "tasks": 9, "faulty": 5})", "faulty"},
          Wrong{R"({"robots": 5, "tasks": 9, "sensors": 100000, "rate": 1000, "seconds": 100000})", "sensors"},
          Wrong{R"({"robots": 5, "tasks": 9, "robot": 3})", "robot"},
          Wrong{R"({"robots": 5, "tasks": 9, "protocol": "mqtt"})", "protocol"},
          Wrong{R"({"protocol": "talkrobots", "robots": 1001, "tasks": 9})", "robots"},
          Wrong{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "link": "string"})", "link"},
          Wrong{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "seed": -1})", "seed"},
          Wrong{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "sensors": 1})", "sensors"},
          Wrong{
              R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": [{"at": 1, "kind": "burn", "node": "r0"}]})",
              "faults[0].kind"},
          Wrong{
              R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": [{"at": 1, "kind": "kill", "node": "r5"}]})",
              "faults[0].node"},
          Wrong{R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": [{"kind": "kill", "node": "r1"}]})",
                "faults[0].at"},
      }) {
    check_refused(one.text, one.key);
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

TEST_CASE("the equations stand beside what was counted, phase by phase") {
  for (
      const char* text :
      {R"({"robots": 5, "tasks": 9, "interpreted": 5, "sensors": 1, "seconds": 180, "remote_requests": 1, "faulty": 1})",
       R"({"robots": 1, "tasks": 4})", R"({"robots": 3, "tasks": 7, "interpreted": 2, "sensors": 2, "rate": 2})"}) {
    CAPTURE(text);
    ConfigFaults faults;
    const Job job = read_job(text, faults);
    REQUIRE(faults.empty());
    counting::Tally tally(1000);
    counting::play(job.plan, tally);
    const Value model = model_value(parameters_of(job));
    for (std::size_t i = 0; i < counting::kPhases; ++i) {
      const Value* messages = model.find("phases")->find(enum_names(CostPhase{})[i]);
      if (messages != nullptr) CHECK(messages->number() == tally.all(static_cast<CostPhase>(i)).messages);
    }
    CHECK(model.find("messages")->number() == tally.all().messages);
  }
}

TEST_CASE("the equations of a world: told field by field, and a robot that fails twice is one") {
  ConfigFaults faults;
  const Job job = read_job(
      R"({"protocol": "talkrobots", "robots": 5, "tasks": 9, "faults": [{"at": 1, "kind": "fail", "node": "r1"},
          {"at": 2, "kind": "fail", "node": "r1"}, {"at": 1, "kind": "kill", "node": "r2"}]})",
      faults);
  REQUIRE(faults.empty());
  CHECK(parameters_of(job) == model::PaperParameters{.n = 5, .N_i = 9, .N_f = 1});
}

TEST_CASE("each task has its begin and its end, and its robot") {
  const counting::Plan plan = *counting::cyclic_plan(2, 3, 1);
  TaskTimes times;
  counting::play(plan, [&](const counting::CountedMessage& message) { times.on_message(message); });
  CHECK(dump_json(times.listed()) == R"([{"id":"t0","robot":"r0","begin_s":0.0,"end_s":3.0},)"
                                     R"({"id":"t1","robot":"r1","begin_s":3.0,"end_s":6.0},)"
                                     R"({"id":"t2","robot":"r0","begin_s":6.0,"end_s":9.0}])");
  CHECK(times.done() == 3);
  CHECK(times.not_listed() == 0);
}

TEST_CASE("of very many tasks the first ones are listed, and the others counted") {
  const counting::Plan plan = *counting::cyclic_plan(2, kMaxListedTasks + 5, 0);
  TaskTimes times;
  counting::play(plan, [&](const counting::CountedMessage& message) { times.on_message(message); });
  CHECK(times.listed().list().size() == kMaxListedTasks);
  CHECK(times.not_listed() == 5);
  CHECK(times.done() == kMaxListedTasks + 5);
}

TEST_CASE("a world's attempts: that of a robot that fails has no end, another robot's has") {
  ConfigFaults faults;
  const Job job = read_job(
      R"({"protocol": "talkrobots", "robots": 2, "tasks": 2, "faults": [{"at": 2, "kind": "fail", "node": "r1"}]})",
      faults);
  REQUIRE(faults.empty());
  world::World world(*job.world);
  TaskTimes times;
  times.watch(world);
  const world::Played played = world.play();
  CHECK(times.done() == played.tasks_done);
  const Value listed = times.listed();
  REQUIRE_FALSE(listed.list().empty());
  const Value& first = listed.list()[0];
  CHECK(first.find("id")->text() == "t0");
  CHECK(first.find("robot")->text() == "r0");
  CHECK(first.find("end_s")->number() - first.find("begin_s")->number() == doctest::Approx(3));
}

TEST_CASE("a line of a trace names both ends") {
  const Value line = trace_value({.at_s = 3,
                                  .phase = CostPhase::forward,
                                  .from = {counting::Party::middleware, 2},
                                  .to = {counting::Party::cloud, 0},
                                  .bytes = 52});
  CHECK(dump_json(line) == R"({"at_s":3.0,"phase":"forward","from":"middleware 2","to":"cloud","bytes":52})");
}

TEST_CASE("a run that `seconds` cut off at work is open and nothing is broken, and the answer says so") {
  ConfigFaults faults;
  const Job job = read_job(R"({"protocol": "talkrobots", "robots": 2, "tasks": 3, "seconds": 6})", faults);
  REQUIRE(faults.empty());
  const Value answer = world_value(world::World(*job.world).play());
  CHECK(answer.find("state")->text() == "OPEN");
  CHECK(answer.find("broken")->list().empty());
  REQUIRE(answer.find("cut_off"));
  CHECK(answer.find("cut_off")->boolean());
  CHECK(answer.find("alerts")->list().empty());
  CHECK(answer.find("at_work")->integer() == 1);
  CHECK_FALSE(answer.find("finished_at_cloud")->boolean());
  CHECK_FALSE(answer.find("stands_still_s"));
  const Job whole = read_job(R"({"protocol": "talkrobots", "robots": 2, "tasks": 3, "seconds": 120})", faults);
  CHECK_FALSE(world_value(world::World(*whole.world).play()).find("cut_off"));
}

TEST_CASE("a run that the cloud has ended is FINISHED, though the time was up while the nodes kept it") {
  ConfigFaults faults;
  const Job job = read_job(R"({"protocol": "talkrobots", "robots": 2, "tasks": 3, "seconds": 9.5})", faults);
  REQUIRE(faults.empty());
  const Value answer = world_value(world::World(*job.world).play());
  CHECK(answer.find("state")->text() == "FINISHED");
  CHECK(answer.find("broken")->list().empty());
  CHECK_FALSE(answer.find("over_everywhere")->boolean());
  REQUIRE(answer.find("cut_off"));
  CHECK(answer.find("finished_at_cloud")->boolean());
}

namespace {

Value world_of(const std::string& more) {
  ConfigFaults faults;
  const Job job = read_job(R"({"protocol": "talkrobots", )" + more + "}", faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  return world_value(world::World(*job.world).play());
}

}  // namespace

TEST_CASE("a run that waits for a person says so, however long it is played") {
  for (const char* const seconds : {"", R"("seconds": 3000, )"}) {
    CAPTURE(seconds);
    const Value world = world_of(seconds + std::string(R"("robots": 1, "tasks": 2,
        "faults": [{"at": 2, "kind": "fail", "node": "r0"}])"));
    CHECK(world.find("state")->text() == "OPEN");
    CHECK(world.find("broken")->list().empty());
    REQUIRE(world.find("alerts")->list().size() == 1);
    const Value& alert = world.find("alerts")->list()[0];
    CHECK(alert.find("robot")->text() == "r0");
    CHECK(alert.find("cause")->text() == "robot_fault");
    CHECK_FALSE(alert.find("tasks")->list().empty());
    CHECK(world.find("stands_still_s")->number() > world::kStill_s);
  }
}

TEST_CASE("a run that its plan keeps from its end stands still, and nothing is broken, however long it is played") {
  const std::string dead = R"("robots": 3, "tasks": 4, "faults": [{"at": 1, "kind": "kill", "node": "cloud"}])";
  const std::string ahead = R"("robots": 3, "tasks": 4, "faults": [{"kind": "clock", "node": "r1", "ahead_s": 1e8}])";
  for (const std::string& more : {dead, ahead}) {
    for (const char* const seconds : {"", R"("seconds": 3000, )"}) {
      CAPTURE(more);
      CAPTURE(seconds);
      const Value world = world_of(seconds + more);
      CHECK(world.find("state")->text() == "OPEN");
      CHECK(world.find("broken")->list().empty());
      REQUIRE(world.find("stands_still_s"));
      CHECK(world.find("stands_still_s")->number() > world::kStill_s);
      CHECK_FALSE(world.find("open_at")->list().empty());
      CHECK(world.find("off")->list().size() == (more == dead ? 1 : 0));
    }
  }
}

TEST_CASE("an answer says whether all links were up, and which faults were not reached, by their place in the job") {
  const Value usual = world_of(R"("robots": 2, "tasks": 2)");
  CHECK(usual.find("all_linked")->boolean());
  CHECK(usual.find("not_reached")->list().empty());
  const Value apart = world_of(R"("robots": 2, "tasks": 2, "seconds": 5, "faults": [{"kind": "cut", "node": "r0"},
      {"at": 2, "kind": "fail", "node": "r1"}, {"at": 6, "kind": "heal", "node": "r0"}])");
  CHECK_FALSE(apart.find("all_linked")->boolean());
  CHECK(dump_json(*apart.find("not_reached")) == R"([{"fault":2,"at":6.0}])");
}

TEST_CASE("seconds of 0 are as none: the run is played to its end") {
  CHECK(world_of(R"("robots": 2, "tasks": 3, "seconds": 0)").find("state")->text() == "FINISHED");
}

TEST_CASE("nothing stands still before the last that is planned has come") {
  const Value world = world_of(R"("robots": 1, "tasks": 2, "seconds": 300,
      "faults": [{"at": 2, "kind": "fail", "node": "r0"}, {"at": 1000, "kind": "repair", "node": "r0"}])");
  CHECK(world.find("cut_off")->boolean());
  CHECK_FALSE(world.find("stands_still_s"));
}

TEST_CASE("an attempt that a robot has given up says when") {
  ConfigFaults faults;
  const Job job = read_job(R"({"protocol": "talkrobots", "fleet": [
      {"id": "a", "profile": {"capabilities": ["run"], "skills": [{"name": "run", "capability": "run", "timeout_s": 2}]}},
      {"id": "b", "profile": {"capabilities": ["run"], "skills": [{"name": "run", "capability": "run", "timeout_s": 60}]}}],
      "scenario": {"name": "late", "tasks": [
        {"id": "slow", "robot": "a", "skill": "run", "on_failure": "continue"},
        {"id": "next", "robot": "b", "skill": "run", "after": ["slow"]}]}})",
                           faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  world::World world(*job.world);
  TaskTimes times;
  times.watch(world);
  world.play();
  const Value listed = times.listed();
  REQUIRE_FALSE(listed.list().empty());
  const Value& slow = listed.list()[0];
  CHECK(slow.find("id")->text() == "slow");
  CHECK(slow.find("end_s") == nullptr);
  REQUIRE(slow.find("failed_s"));
  CHECK(slow.find("failed_s")->number() - slow.find("begin_s")->number() == doctest::Approx(2).epsilon(0.05));
}

TEST_CASE("the equations of a fleet and its scenario: their blocks, and who was given a task that names nobody") {
  ConfigFaults faults;
  const Job job = read_job(R"({"protocol": "talkrobots", "fleet": [
      {"id": "a", "profile": {"capabilities": ["run"], "skills": [{"name": "run", "capability": "run", "timeout_s": 60}]}},
      {"id": "b", "profile": {"capabilities": ["go"], "skills": [{"name": "go", "capability": "go", "timeout_s": 60}]}},
      {"id": "c", "profile": {}}],
      "scenario": {"name": "blocks", "tasks": [
        {"id": "t0", "robot": "a", "skill": "run"},
        {"id": "t1", "robot": "a", "skill": "run", "after": ["t0"]},
        {"id": "t2", "requires": ["go"], "skill": "go", "after": ["t1"],
         "when": {"sensor": "t", "of": "a", "op": "<", "value": 1, "unit": ""}}]},
      "sensor_values": [{"node": "a", "name": "t", "value": 0}],
      "faults": [{"at": 90, "kind": "fail", "node": "c"}]})",
                           faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  const model::PaperParameters p = parameters_of(job);
  CHECK(p == model::PaperParameters{.n = 3, .N_i = 3, .k = 1, .sum_m = 2, .s = 1, .R_l = 1, .N_f = 1});
  CHECK(model::forward(p) == 1);
}
