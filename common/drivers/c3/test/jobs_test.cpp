// The messages for a KUKA's program, by themselves: phase by phase.
#include "common/drivers/c3/jobs.hpp"

#include "common/drivers/c3/test/parts.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

/// A program without fields: one word, a done flag, a result.
struct JobsBench : C3Bench {
  C3Names names = *read_c3_names({{"trb_done", "READY"}, {"trb_result", "RESULT"}}, false);
  C3Turns turns{link, polls, {{{"HALT", "TRUE"}}, {}, false}};
  C3Jobs jobs{{names, link, polls, turns},
              {false, 0, std::chrono::seconds(2), 0},
              {{"go", C3Words(*read_c3_assignments("GOAL = {0}"))}}};

  Status add(Token token, const char* skill = "") {
    return jobs.add({token, MessageType::command, "go", "operator", "[3]", skill}, now, out);
  }
  void written() { jobs.on_written(answer(""), now, out); }
  /// The program raises its flag over this result, which is read and cleared.
  void finish(const std::string& result) {
    jobs.on_done_flag(true, now, out);
    jobs.on_part(answer(result).reply);
    answer("");
    jobs.on_cleared(now, out);
  }
};

/// One that takes messages field by field.
struct FieldBench : C3Bench {
  C3Names names = *read_c3_names({}, true);
  C3Turns turns{link, polls, {}};
  C3Jobs jobs{{names, link, polls, turns}, {true, 80, std::chrono::seconds(2), 0}, {}};

  void offer(Token token, const std::string& data = "") {
    CHECK(jobs.add({token, MessageType::command, "wave", "operator", data, ""}, now, out));
    while (!jobs.waits_to_be_taken()) jobs.on_written(answer(""), now, out);
  }
};

}  // namespace

TEST_CASE("words are written one after the other, then the program runs; its end is told once") {
  JobsBench bench;
  CHECK(bench.add(1, "reach"));
  CHECK(bench.sent() == "READY=FALSE ");
  bench.written();
  CHECK(bench.sent() == "GOAL=3 ");
  bench.written();
  bench.jobs.on_done_flag(false, bench.now, bench.out);
  bench.jobs.on_done_flag(false, bench.now, bench.out);
  CHECK(bench.told<Started>().size() == 1);
  CHECK(bench.jobs.runs(1));
  bench.finish("0");
  CHECK(bench.told<Ended>().at(0).well);
  CHECK_FALSE(bench.jobs.runs(1));
}

TEST_CASE("a second message waits for the first, none is taken while a skill runs") {
  JobsBench bench;
  CHECK(bench.add(1));
  CHECK(bench.add(2));
  CHECK(bench.sent() == "READY=FALSE ");
  bench.written();
  bench.written();
  bench.finish("7");
  CHECK(bench.told<Refused>().at(0).token == 1);
  CHECK(bench.sent() == "READY=FALSE ");
  CHECK(bench.add(3, "reach"));
  CHECK(bench.add(4).error().code == Errc::busy);
}

TEST_CASE("a write that the robot refuses ends the message, and its answer names the variable") {
  JobsBench bench;
  CHECK(bench.add(1));
  CHECK(bench.add(2));
  bench.jobs.on_written(bench.answer("", false), bench.now, bench.out);
  const auto refused = bench.told<Refused>();
  REQUIRE(refused.size() == 1);
  CHECK(refused[0].error.what.find("READY") != std::string::npos);
  CHECK(bench.jobs.runs(2));
}

TEST_CASE("while a stop is open nothing begins") {
  JobsBench bench;
  bench.turns.stop(bench.now, bench.out);
  CHECK(bench.sent() == "HALT=TRUE ");
  CHECK(bench.add(1));
  CHECK(bench.sent().empty());
  bench.turns.on_written(bench.answer(""), bench.now, bench.out);
  bench.jobs.begin_next(bench.now, bench.out);
  CHECK(bench.sent() == "READY=FALSE ");
}

TEST_CASE("what is halted while it runs is to be stopped; what is not yet taken is withdrawn") {
  JobsBench moving;
  CHECK(moving.add(1));
  moving.written();
  moving.written();
  CHECK(moving.jobs.halt(1, moving.now, moving.out));
  FieldBench offered;
  offered.offer(1);
  offered.sent();
  CHECK_FALSE(offered.jobs.halt(1, offered.now, offered.out));
  CHECK(offered.sent() == "TRB_COMMAND=FALSE ");
}

TEST_CASE("a chunk waits until the program has taken the one before") {
  FieldBench bench;
  CHECK(bench.jobs.add({1, MessageType::command, "wave", "operator", std::string(100, 'x'), ""}, bench.now, bench.out));
  while (!bench.jobs.waits_for_chunk()) bench.jobs.on_written(bench.answer(""), bench.now, bench.out);
  bench.jobs.on_chunk_flag(true, bench.now, bench.out);
  CHECK(bench.sent().empty());
  bench.jobs.on_chunk_flag(false, bench.now, bench.out);
  CHECK(bench.sent() == "TRB_DATA[]=\"" + std::string(20, 'x') + "\" ");
}

TEST_CASE("a program that does not take a message in time: the message is refused and withdrawn") {
  FieldBench bench;
  bench.offer(1);
  bench.sent();
  bench.jobs.check_patience(bench.now, bench.out);
  CHECK(bench.told<Refused>().empty());
  bench.now.mono = bench.now.mono + std::chrono::seconds(2);
  bench.jobs.check_patience(bench.now, bench.out);
  CHECK(bench.told<Refused>().at(0).error.code == Errc::robot_error);
  CHECK(bench.sent() == "TRB_COMMAND=FALSE ");
}

TEST_CASE("all are dropped: what waits is refused, what was answered is not; what is offered is to be cleared") {
  FieldBench bench;
  bench.offer(1);
  bench.jobs.on_command_flag(false, bench.now, bench.out);
  bench.jobs.on_done_flag(false, bench.now, bench.out);
  CHECK(bench.told<Started>().size() == 1);
  CHECK(bench.jobs.add({2, MessageType::command, "wave", "operator", "", ""}, bench.now, bench.out));
  CHECK_FALSE(bench.jobs.drop(fail(Errc::fenced, "stopped"), bench.out));
  const auto refused = bench.told<Refused>();
  REQUIRE(refused.size() == 1);
  CHECK(refused[0].token == 2);
  bench.offer(3);
  CHECK(bench.jobs.drop(fail(Errc::fenced, "stopped"), bench.out));
}

TEST_CASE("the robot has stopped its program: the skill under way has failed, with the reason") {
  JobsBench bench;
  CHECK(bench.add(1, "reach"));
  bench.written();
  bench.written();
  const C3Jobs::Broken broken = bench.jobs.fail_all(fail(Errc::robot_error, "why"), bench.out);
  CHECK(broken.moved);
  CHECK_FALSE(broken.offered);
  const auto ended = bench.told<Ended>();
  REQUIRE(ended.size() == 1);
  CHECK_FALSE(ended[0].well);
  CHECK(ended[0].text == "why");
}
