// Skills: one at a time, each attempt with one outcome, told until it is journaled.
#include "services/mode-adapter/test/bench.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

class SkillBench : public Bench {
 public:
  explicit SkillBench(Settings settings = pioneer()) : Bench(std::move(settings)) { up(Channel::field); }
  std::uint64_t execute(const Execute& order) { return deliver(MessageType::command, order, "pioneer"); }
  std::uint64_t query(std::uint32_t number = 1) {
    return deliver(MessageType::request, ExecutionQuery{attempt(number)}, "pioneer");
  }
  std::uint64_t cancel(std::uint32_t number = 1) {
    return deliver(MessageType::command, CancelExecution{attempt(number), "the run is aborted"}, "pioneer");
  }
  void journaled(std::uint32_t number = 1) {
    deliver(MessageType::information, OutcomeJournaled{attempt(number)}, "pioneer");
  }
  /// The robot has taken `home` and says that it has carried it out.
  void finish() {
    take_fields();
    say("information\ndone\n\n4\nhome\n");
  }
};

Settings with_end(const SkillEnd& end) {
  Settings settings = pioneer();
  settings.description.skills[0].end = end;
  return settings;
}

constexpr const char* kToDock = R"({"place": "dock"})";
constexpr const char* kHomeJoints = R"({"joints": [0.5, 0.5, 0.5, 0.5, 0.5, 0.5]})";

}  // namespace

TEST_CASE("a skill: begun, done, told again every second until it is journaled") {
  SkillBench bench;
  const auto id = bench.execute(order("go_to", kToDock));
  CHECK(bench.answer(id) == "running");
  CHECK(bench.take_fields() == "command\ngo_to\npioneer\n3\n1 2\n");
  bench.wait(1.5);
  bench.say("information\ndone\n\n11\ngo_to at 17\n");
  const auto outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::finished);
  CHECK(outcome.instance == kInstance);
  CHECK(outcome.data == "\"at 17\"");
  CHECK(outcome.duration_s == doctest::Approx(1.5));
  CHECK(bench.counted("from_robot.done") == 1);
  bench.wait(2.5);
  CHECK(bench.told<Outcome>().size() == 2);
  bench.journaled();
  bench.wait(5);
  CHECK(bench.told<Outcome>().empty());
  bench.wait(10);  // its control lease
  CHECK_FALSE(bench.core.next_deadline());
}

TEST_CASE("the same attempt twice is one attempt") {
  SkillBench bench;
  bench.execute(order("home", ""));
  CHECK(bench.answer(bench.execute(order("home", ""))) == "running");
  bench.finish();
  CHECK(bench.counted("to_robot.home") == 5);
  CHECK(bench.answer(bench.execute(order("home", ""))) == "finished");
  bench.journaled();
  CHECK(bench.answer(bench.execute(order("home", ""))) == "finished");
  CHECK(bench.written().empty());
}

TEST_CASE("an order for an earlier start of the process, or from another node, is refused") {
  SkillBench bench;
  Execute stale = order("home", "");
  stale.instance = kInstance - 1;
  CHECK(bench.answer(bench.execute(stale)) == "nack stale_instance");
  CHECK(bench.answer(bench.deliver(MessageType::command, order("home", ""), "ur3")) == "nack not_permitted");
  CHECK(bench.written().empty());
}

TEST_CASE("one skill at a time") {
  SkillBench bench;
  bench.execute(order("home", ""));
  CHECK(bench.answer(bench.execute(order("home", "", 2))) == "nack busy");
  bench.finish();
  CHECK(bench.answer(bench.execute(order("home", "", 2))) == "running");
}

TEST_CASE("a robot that is not connected is asked for nothing, and the attempt may be made again") {
  Bench bench(pioneer());
  CHECK(bench.answer(bench.deliver(MessageType::command, order("home", ""), "pioneer")) == "nack robot_offline");
  bench.up(Channel::field);
  CHECK(bench.answer(bench.deliver(MessageType::command, order("home", ""), "pioneer")) == "running");
}

TEST_CASE("what can never succeed has failed at once, with the parameter's name") {
  SkillBench bench;
  CHECK(bench.answer(bench.execute(order("fly", ""))) == "failed");
  CHECK(bench.answer(bench.execute(order("go_to", "{}", 2))) == "failed");
  CHECK(bench.answer(bench.execute(order("go_to", R"({"place": "moon"})", 3))) == "failed");
  bench.out.clear();
  bench.wait(1);
  const auto told = bench.told<Outcome>();
  REQUIRE(told.size() == 3);
  CHECK(get<Outcome>(told[0].body).reason.find("unknown_skill") != std::string::npos);
  CHECK(get<Outcome>(told[1].body).reason.find("'place'") != std::string::npos);
  CHECK(get<Outcome>(told[2].body).reason.find("'moon'") != std::string::npos);
}

TEST_CASE("a robot that says `failed` gives its reason; a `done` that comes late is counted and dropped") {
  SkillBench bench;
  bench.execute(order("home", ""));
  bench.say("information\ndone\n\n4\nhome\n");  // it has not even heard of it
  CHECK(bench.told<Outcome>().empty());
  bench.take_fields();
  bench.say("information\nfailed\n\n12\nhome blocked\n");
  const auto outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::failed);
  CHECK(outcome.reason == "blocked");
  bench.say("information\ndone\n\n4\nhome\n");
  CHECK(bench.told<Outcome>().empty());
  CHECK(bench.counted("refused.late_done") == 2);
}

TEST_CASE("a connection lost while a skill runs: nobody knows, so it is interrupted") {
  SkillBench bench;
  bench.execute(order("home", ""));
  bench.take_fields();
  bench.down(Channel::field, "connection reset by peer");
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::interrupted);
}

TEST_CASE("time-out: the motion is stopped without a fence, and what is said of it later counts for nothing") {
  SkillBench bench;
  Execute late = order("home", "");
  late.timeout_s = 2.5;
  bench.execute(late);
  bench.take_fields();
  bench.wait(2.5);
  const auto outcome = bench.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::failed);
  CHECK(outcome.reason == "timed out after 2.5 s");
  CHECK(bench.written() == "!stop\n!release\n");
  CHECK(bench.fence_writes.empty());
  bench.execute(order("home", "", 2));
  CHECK(bench.written().empty());  // not before the robot has stopped
  bench.say("information\ndone\n\n4\nhome\n!stopped\n!released\n");
  CHECK(bench.told<Outcome>().empty());
  CHECK(bench.take_fields() == "command\nhome\npioneer\n0\n\n");
}

TEST_CASE("cancelled while it runs, after it has ended, and before it was ever heard of") {
  SkillBench bench;
  bench.execute(order("home", ""));
  bench.take_fields();
  CHECK(bench.answer(bench.cancel()) == "failed");
  CHECK(bench.written() == "!stop\n!release\n");
  bench.say("!stopped\n!released\n");
  const auto told = bench.told<Outcome>();
  REQUIRE(told.size() == 2);
  CHECK(get<Outcome>(told[0].body).reason == "cancelled: the run is aborted");

  CHECK(bench.answer(bench.cancel(2)) == "failed");
  CHECK(bench.answer(bench.execute(order("home", "", 2))) == "failed");
  CHECK(bench.written().empty());

  bench.execute(order("home", "", 3));
  bench.finish();
  CHECK(bench.answer(bench.cancel(3)) == "finished");
}

TEST_CASE("a cancelled skill that the robot has not begun to hear of is taken out of the queue, nothing is stopped") {
  SkillBench bench;
  bench.command("move", "1");
  bench.execute(order("home", ""));
  bench.cancel();
  CHECK(bench.take_fields() == "command\nmove\noperator\n1\n1\n");
  CHECK(bench.written().empty());
}

TEST_CASE("asked what became of an attempt") {
  SkillBench bench;
  CHECK(bench.answer(bench.query()) == "unknown");
  bench.execute(order("home", ""));
  CHECK(bench.answer(bench.query()) == "running");
  bench.finish();
  CHECK(bench.answer(bench.query()) == "finished");
}

TEST_CASE("256 outcomes that nobody journals are the most; journaled ones make room") {
  SkillBench bench;
  for (std::uint32_t i = 1; i <= 256; ++i) bench.cancel(i);
  CHECK(bench.answer(bench.execute(order("home", "", 300))) == "nack busy");
  bench.journaled(7);
  CHECK(bench.answer(bench.execute(order("home", "", 300))) == "running");
  CHECK(bench.answer(bench.query(7)) == "unknown");
  CHECK(bench.answer(bench.query(8)) == "failed");
}

TEST_CASE("the end is a state that the robot tells its node") {
  SkillBench bench(with_end({EndKind::state, "gripper", 2, 0, "", 0}));
  bench.execute(order("go_to", kToDock));
  bench.say("information\ngripper\n\n1\n2\n");  // before it has the command
  bench.take_fields();
  bench.say("information\ngripper\n\n1\n1\n");
  CHECK(bench.told<Outcome>().empty());
  bench.say("information\ngripper\n\n1\n2\n");
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("the end is a position: the robot's frame and units, near enough") {
  Settings settings = with_end({EndKind::position, "", 0, 15, "place", 0});
  settings.description.frame.length = 1000;
  settings.description.frame.origin = {1, 1, 0, 0};
  SkillBench bench(settings);
  bench.execute(order("go_to", kToDock));
  CHECK(bench.take_fields() == "command\ngo_to\npioneer\n6\n0 1000\n");
  bench.say("information\nposition\n\n5\n0 980\n");
  CHECK(bench.told<Outcome>().empty());
  bench.say("information\ndone\n\n5\ngo_to\n");  // it says so, but it is not there
  CHECK(bench.told<Outcome>().empty());
  bench.say("information\nposition\n\n8\n10 990 0\n");
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("the end is a time, counted from when the robot has the command") {
  SkillBench bench(with_end({EndKind::time, "", 0, 0, "", 3}));
  bench.execute(order("go_to", kToDock));
  bench.wait(1);
  bench.take_fields();
  bench.wait(2.9);
  CHECK(bench.told<Outcome>().empty());
  bench.wait(0.1);
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("an arm's program that came to its end has finished, one that was cut short has failed") {
  for (const bool text_first : {true, false}) {
    UrBench bench;
    bench.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
    bench.monitor(ur_started("trb_1"));
    bench.monitor(text_first ? ur_text("trb_1 done") : ur_stopped("trb_1"));
    CHECK(bench.told<Outcome>().empty());
    bench.monitor(text_first ? ur_stopped("trb_1") : ur_text("trb_1 done"));
    CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
  }
  UrBench cut;
  cut.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
  cut.monitor(ur_started("trb_1") + ur_stopped("trb_0") + ur_stopped("trb_1"));
  cut.wait(0.2);
  const auto outcome = cut.one<Outcome>();
  CHECK(outcome.outcome == TaskOutcome::failed);
  CHECK(outcome.reason.find("before its end") != std::string::npos);
}

TEST_CASE("an arm that refuses a skill's program, or raises an exception in it, has failed it in its own words") {
  UrBench refused;
  refused.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
  refused.monitor(ur_exception(1, 1, "runtime_error_robot_not_running:"));
  CHECK(refused.one<Outcome>().reason == "line 1, column 1: runtime_error_robot_not_running:");
  UrBench raised;
  raised.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
  raised.monitor(ur_started("trb_1") + ur_exception(2, 3, "runtime_error_no_inverse:") + ur_stopped("trb_1"));
  CHECK(raised.one<Outcome>().reason == "line 2, column 3: runtime_error_no_inverse:");
}

TEST_CASE("a cancelled arm is told the vendor's stop, no fence is set") {
  UrBench bench;
  bench.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
  bench.monitor(ur_started("trb_1"));
  bench.sent();
  bench.deliver(MessageType::command, CancelExecution{attempt(), "no"}, "ur3");
  CHECK(bench.sent() == "stop program\n");
  bench.monitor(ur_stopped("trb_1"));
  bench.wait(0.5);
  const auto told = bench.told<Outcome>();
  REQUIRE(told.size() == 2);  // the news and the answer
  CHECK(get<Outcome>(told[0].body).outcome == TaskOutcome::failed);
  CHECK(bench.fence_writes.empty());
}

TEST_CASE("an arm at its target: a state from before the command does not count") {
  Settings settings = ur3();
  settings.description.skills[0].end = {EndKind::position, "", 0, 0.01, "joints", 0};
  UrBench bench(settings);
  bench.deliver(MessageType::command, order("reach", kHomeJoints), "ur3");
  bench.monitor(ur_started("trb_1") + ur_state({.running = true}));
  CHECK(bench.told<Outcome>().empty());
  bench.live(0.2, {.running = true, .joint = 0.4});
  CHECK(bench.told<Outcome>().empty());
  bench.live(0.1, {.running = true, .joint = 0.495});
  CHECK(bench.one<Outcome>().outcome == TaskOutcome::finished);
}

TEST_CASE("a skill whose end can never be heard is refused when it is asked for, not when it times out") {
  Settings settings = ur3();
  settings.commands.wrap.clear();
  UrBench bench(settings);
  CHECK(bench.answer(bench.deliver(MessageType::command, order("reach", kHomeJoints), "ur3")) == "failed");
  CHECK(bench.sent().empty());
}
