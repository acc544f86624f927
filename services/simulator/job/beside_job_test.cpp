// Jobs of several runs at once: a hall's scenarios, and counted tasks that are divided.
#include <doctest/doctest.h>

#include "services/simulator/job/alone.hpp"
#include "services/simulator/job/job.hpp"
#include "services/simulator/job/task_times.hpp"
#include "services/simulator/job/test/refused_job.hpp"
#include "services/simulator/job/world_job.hpp"

using namespace trb;
using namespace trb::simulator;
using namespace trb::simulator::test;

namespace {

const std::string kCartAndArm = R"([
  {"id": "cart", "profile": {"capabilities": ["drive"], "skills":
    [{"name": "drive", "capability": "drive", "repeatable": true, "timeout_s": 60}]}},
  {"id": "arm", "profile": {"capabilities": ["grip"], "skills": [{"name": "pick", "capability": "grip", "timeout_s": 60}]}}])";

std::string scenario_of(const std::string& name, const std::string& tasks) {
  return R"({"name": ")" + name + R"(", "tasks": [)" + tasks + "]}";
}

const std::string kDrive = R"({"id": "go", "robot": "cart", "skill": "drive"})";
const std::string kPick = R"({"id": "take", "requires": ["grip"], "skill": "pick"})";

std::string beside_job(const std::string& beside, const std::string& more = "") {
  return R"({"protocol": "talkrobots", "fleet": )" + kCartAndArm + R"(, "scenario": )" + scenario_of("one", kDrive) +
         R"(, "beside": )" + beside + more + "}";
}

std::string counted_job(const std::string& more) {
  return R"({"protocol": "talkrobots", )" + more + "}";
}

world::WorldPlan world_plan_of(const std::string& text) {
  ConfigFaults faults;
  Job job = read_job(text, faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  return std::move(*job.world);
}

std::string number_text(const Value& of, const char* key) {
  return dump_json(*of.find(key));
}

}  // namespace

TEST_CASE("scenarios beside the first one are bound as it is, and told by themselves") {
  const std::string second = scenario_of("two", kDrive + ", " + kPick);
  const world::WorldPlan plan = world_plan_of(beside_job(R"([{"scenario": )" + second + R"(, "after": 1}])"));
  REQUIRE(plan.beside.size() == 1);
  CHECK(plan.beside[0].after_s == 1);
  CHECK(plan.beside[0].assigned == std::vector<std::string>{"cart", "cloud"});
  CHECK(plan.tasks_in_all() == 3);
  world::World world(plan);
  TaskTimes times;
  times.watch(world);
  CHECK(world.play().tasks_done == 1);
  const Value told{beside_value(world.runs()[1])};
  CHECK(told.find("scenario")->text() == "two");
  CHECK(told.find("state")->text() == "FINISHED");
  CHECK(number_text(told, "tasks_done") == "2");
  CHECK(number_text(told, "after_s") == "1.0");
  CHECK(told.find("broken")->list().empty());
  CHECK(told.find("cut_off") == nullptr);
  // Both have a task "go": each run's attempts stand in its own list.
  CHECK(times.listed(0).list().size() == 1);
  CHECK(times.listed(1).list().size() == 2);
  CHECK(times.not_listed(1) == 0);
}

TEST_CASE("a time may be that of a skill or a task that only another run has") {
  const std::string second = scenario_of("two", kPick);
  const std::string beside = R"([{"scenario": )" + second + "}]";
  CHECK(world_plan_of(beside_job(beside, R"(, "times": {"pick": 5, "task:go": 2})")).times.size() == 2);
  check_refused(beside_job(beside, R"(, "times": {"fly": 5})"), "times.fly");
}

TEST_CASE("each run is played by itself, too, if that is asked for: at once, without the others") {
  const std::string beside = R"([{"scenario": )" + scenario_of("two", kDrive + ", " + kPick) + R"(, "after": 1}])";
  ConfigFaults faults;
  const Job job = read_job(beside_job(beside, R"(, "alone": true, "times": {"pick": 5, "drive": 4})"), faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  CHECK(job.alone);
  Value answer{Value::Object{{"beside", Value{Value::List{Value{Value::Object{}}}}}}};
  add_alone(answer, *job.world, {});
  CHECK(answer.find("alone_s")->number() == doctest::Approx(4).epsilon(0.02));
  CHECK(answer.find("beside")->list()[0].find("alone_s")->number() == doctest::Approx(5).epsilon(0.02));
  // Cut off before its end, it has none.
  ConfigFaults none;
  const Job cut =
      read_job(beside_job(beside, R"(, "alone": true, "seconds": 4.5, "times": {"pick": 5, "drive": 4})"), none);
  answer = Value{Value::Object{{"beside", Value{Value::List{Value{Value::Object{}}}}}}};
  add_alone(answer, *cut.world, {});
  CHECK(answer.find("alone_s")->is_number());
  CHECK(answer.find("beside")->list()[0].find("alone_s")->is_null());
}

TEST_CASE("a run is asked for alone only beside others") {
  check_refused(counted_job(R"("robots": 2, "tasks": 2, "alone": true)"), "alone");
  check_refused(counted_job(R"("fleet": )" + kCartAndArm + R"(, "scenario": )" + scenario_of("one", kDrive) +
                            R"(, "alone": true)"),
                "alone");
}

TEST_CASE("a condition beside the first scenario that no sensor answers is named by its place") {
  const std::string waits = R"({"id": "go", "robot": "cart", "skill": "drive",
      "when": {"sensor": "t", "of": "cart", "op": ">", "value": 20, "unit": "degC"}})";
  check_refused(beside_job(R"([{"scenario": )" + scenario_of("x", waits) + "}]"), "beside[0].scenario");
}

TEST_CASE("what is wrong with a scenario beside the first one is named by its place") {
  const auto with = [](const std::string& tasks) {
    return beside_job(R"([{"scenario": )" + scenario_of("x", kPick) + R"(}, {"scenario": )" + scenario_of("x", tasks) +
                      "}]");
  };
  check_refused(with(R"({"id": "t", "robot": "arm", "skill": "fly"})"), "beside[1].scenario.tasks[0].skill");
  check_refused(with(R"({"id": "t", "robot": "nobody", "skill": "pick"})"), "beside[1].scenario.tasks[0].robot");
  check_refused(with(""), "beside[1].scenario.tasks");
  check_refused(beside_job(R"([{"after": 1}])"), "beside[0].scenario");
  check_refused(beside_job(R"([{"scenario": )" + scenario_of("x", kPick) + R"(, "after": -1}])"), "beside[0].after");
  check_refused(beside_job(R"([{"scenario": )" + scenario_of("x", kPick) + R"(, "first": 1}])"), "beside[0].first");
  std::string ten = "[";
  for (int i = 0; i < 10; ++i) ten += (i == 0 ? "" : ", ") + (R"({"scenario": )" + scenario_of("x", kPick) + "}");
  check_refused(beside_job(ten + "]"), "beside");
  check_refused(counted_job(R"("robots": 2, "tasks": 2, "beside": [])"), "beside");
}

TEST_CASE("counted tasks are divided into runs, which have at most what a run may have") {
  const world::WorldPlan plan =
      world_plan_of(counted_job(R"("robots": 1000, "tasks": 10000, "runs": 10, "at_once": true)"));
  CHECK(plan.division.runs == 10);
  CHECK(plan.division.at_once);
  check_refused(counted_job(R"("robots": 15, "tasks": 10000, "runs": 10)"), "tasks");
  check_refused(counted_job(R"("robots": 1000, "tasks": 1000)"), "robots");
  check_refused(counted_job(R"("robots": 10, "tasks": 2001, "runs": 2)"), "tasks");
  check_refused(counted_job(R"("robots": 10, "tasks": 20, "runs": 101)"), "runs");
  check_refused(R"({"robots": 2, "tasks": 2, "runs": 2})", "runs");
}
