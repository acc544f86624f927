// The messages for a KUKA's program, by themselves: phase by phase.
#include "common/drivers/c3/jobs.hpp"

#include "common/drivers/c3/test/parts.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

/// A program without fields: one word, a done flag, a result.
struct JobsFixture : PartsFixture {
  C3Names names = *read_c3_names({{"trb_done", "READY"}, {"trb_result", "RESULT"}}, false);
  C3Turns turns{link, polls, {{{"HALT", "TRUE"}}, {}, false}};
  C3Jobs jobs{{names, link, polls, turns},
              {false, 0, std::chrono::seconds(2), 0},
              {{"go", C3Command(*read_c3_assignments("GOAL = {0}"))}}};

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
struct FieldFixture : PartsFixture {
  C3Names names = *read_c3_names({}, true);
  C3Turns turns{link, polls, {}};
  C3Jobs jobs{{names, link, polls, turns}, {true, 80, std::chrono::seconds(2), 0}, {}};

  Status add(Token token, MessageType type, const std::string& data = "", const char* skill = "") {
    return jobs.add({token, type, "wave", "operator", data, skill}, now, out);
  }
  void offer(Token token, const std::string& data = "") {
    CHECK(jobs.add({token, MessageType::command, "wave", "operator", data, ""}, now, out));
    while (!jobs.waits_to_be_taken()) jobs.on_written(answer(""), now, out);
  }
};

}  // namespace

TEST_CASE("words are written one after the other, then the program runs; its end is told once") {
  JobsFixture fixture;
  CHECK(fixture.add(1, "reach"));
  CHECK(fixture.sent() == "READY=FALSE ");
  fixture.written();
  CHECK(fixture.sent() == "GOAL=3 ");
  fixture.written();
  fixture.jobs.on_done_flag(false, fixture.now, fixture.out);
  fixture.jobs.on_done_flag(false, fixture.now, fixture.out);
  CHECK(fixture.told<Started>().size() == 1);
  CHECK(fixture.jobs.runs(1));
  fixture.finish("0");
  CHECK(fixture.told<Ended>().at(0).well);
  CHECK_FALSE(fixture.jobs.runs(1));
}

TEST_CASE("a second message waits for the first, none is taken while a skill runs") {
  JobsFixture fixture;
  CHECK(fixture.add(1));
  CHECK(fixture.add(2));
  CHECK(fixture.sent() == "READY=FALSE ");
  fixture.written();
  fixture.written();
  fixture.finish("7");
  CHECK(fixture.told<Refused>().at(0).token == 1);
  CHECK(fixture.sent() == "READY=FALSE ");
  CHECK(fixture.add(3, "reach"));
  CHECK(fixture.add(4).error().code == Errc::busy);
}

TEST_CASE("a write that the robot refuses ends the message, and its answer names the variable") {
  JobsFixture fixture;
  CHECK(fixture.add(1));
  CHECK(fixture.add(2));
  fixture.jobs.on_written(fixture.answer("", false), fixture.now, fixture.out);
  const auto refused = fixture.told<Refused>();
  REQUIRE(refused.size() == 1);
  CHECK(refused[0].error.what.find("READY") != std::string::npos);
  CHECK(fixture.jobs.runs(2));
}

TEST_CASE("while a stop is open nothing begins") {
  JobsFixture fixture;
  fixture.turns.stop(fixture.now, fixture.out);
  CHECK(fixture.sent() == "HALT=TRUE ");
  CHECK(fixture.add(1));
  CHECK(fixture.sent().empty());
  fixture.turns.on_written(fixture.answer(""), fixture.now, fixture.out);
  fixture.jobs.begin_next(fixture.now, fixture.out);
  CHECK(fixture.sent() == "READY=FALSE ");
}

TEST_CASE("what is halted is to be stopped if the program may have it, and is withdrawn; else it is only withdrawn") {
  JobsFixture moving;
  CHECK(moving.add(1));
  moving.written();
  moving.written();
  CHECK(moving.jobs.halt(1, moving.now, moving.out));
  FieldFixture offered;
  offered.offer(1);
  offered.sent();
  CHECK(offered.jobs.halt(1, offered.now, offered.out));
  CHECK(offered.sent() == "TRB_COMMAND=FALSE ");
  FieldFixture writing;
  CHECK(writing.jobs.add({1, MessageType::command, "wave", "operator", "1", ""}, writing.now, writing.out));
  CHECK_FALSE(writing.jobs.halt(1, writing.now, writing.out));
  CHECK_FALSE(writing.jobs.runs(1));
}

TEST_CASE("what may have been taken before its halt was refused has the program until its end, or the patience long") {
  for (const bool taken : {false, true}) {
    FieldFixture fixture;
    fixture.offer(1);
    CHECK(fixture.jobs.halt(1, fixture.now, fixture.out));
    fixture.answer("");
    fixture.sent();
    fixture.jobs.on_halt_refused(fixture.now, fixture.out);
    CHECK(fixture.jobs.add({2, MessageType::command, "wave", "operator", "", ""}, fixture.now, fixture.out));
    CHECK(fixture.sent().empty());
    if (taken) {
      fixture.jobs.on_done_flag(true, fixture.now, fixture.out);
      for (const char* part : {"1", "0", "\"\""}) fixture.jobs.on_part(fixture.answer(part).reply);
      fixture.answer("");
      fixture.jobs.on_cleared(fixture.now, fixture.out);
    } else {
      fixture.now.mono = fixture.now.mono + seconds(1.9);
      fixture.jobs.check_patience(fixture.now, fixture.out);
      CHECK(fixture.sent().empty());
      fixture.now.mono = fixture.now.mono + seconds(0.1);
      fixture.jobs.check_patience(fixture.now, fixture.out);
    }
    CHECK_FALSE(fixture.jobs.runs(1));
    CHECK(fixture.jobs.runs(2));
    CHECK_FALSE(fixture.sent().empty());
    CHECK(fixture.told<Refused>().empty());
  }
}

TEST_CASE("a chunk waits until the program has taken the one before") {
  FieldFixture fixture;
  CHECK(fixture.jobs.add({1, MessageType::command, "wave", "operator", std::string(100, 'x'), ""}, fixture.now,
                         fixture.out));
  while (!fixture.jobs.waits_for_chunk()) fixture.jobs.on_written(fixture.answer(""), fixture.now, fixture.out);
  fixture.jobs.on_chunk_flag(true, fixture.now, fixture.out);
  CHECK(fixture.sent().empty());
  fixture.jobs.on_chunk_flag(false, fixture.now, fixture.out);
  CHECK(fixture.sent() == "TRB_DATA[]=\"" + std::string(20, 'x') + "\" ");
}

TEST_CASE("a program that does not take a message in time: the message is refused and withdrawn") {
  FieldFixture fixture;
  fixture.offer(1);
  fixture.sent();
  fixture.jobs.check_patience(fixture.now, fixture.out);
  CHECK(fixture.told<Refused>().empty());
  fixture.now.mono = fixture.now.mono + std::chrono::seconds(2);
  fixture.jobs.check_patience(fixture.now, fixture.out);
  CHECK(fixture.told<Refused>().at(0).error.code == Errc::robot_error);
  CHECK(fixture.sent() == "TRB_COMMAND=FALSE ");
}

TEST_CASE("each kind of message has its places, so that what anybody may send keeps out no command and no skill") {
  FieldFixture fixture;
  for (Token token = 1; token <= 65; ++token) CHECK(fixture.add(token, MessageType::information));
  CHECK(fixture.add(66, MessageType::information).error().code == Errc::queue_full);
  for (Token token = 101; token <= 164; ++token) CHECK(fixture.add(token, MessageType::request));
  CHECK(fixture.add(165, MessageType::request).error().code == Errc::queue_full);
  CHECK(fixture.add(201, MessageType::command));
  CHECK(fixture.add(202, MessageType::command, "", "reach"));
}

TEST_CASE("what waits is bounded in bytes, too, for each kind") {
  FieldFixture fixture;
  const std::string largest(1U << 20U, '\0');
  CHECK(fixture.add(1, MessageType::information));  // it is being written, and does not wait
  CHECK(fixture.add(2, MessageType::information, largest));
  CHECK(fixture.add(3, MessageType::information, "1").error().code == Errc::queue_full);
  CHECK(fixture.add(4, MessageType::command, "1"));
}

TEST_CASE("a skill is written before all that waits, and in place of what anybody may send") {
  FieldFixture fixture;
  CHECK(fixture.add(1, MessageType::information, std::string(200, 'x')));
  CHECK(fixture.add(2, MessageType::request));
  while (!fixture.jobs.waits_for_chunk()) fixture.jobs.on_written(fixture.answer(""), fixture.now, fixture.out);
  CHECK(fixture.add(3, MessageType::command, "7", "reach"));
  CHECK(fixture.told<Refused>().at(0).error.code == Errc::busy);
  CHECK(fixture.sent() == "TRB_COMMAND=FALSE ");
  fixture.answer("");
  while (!fixture.jobs.waits_to_be_taken()) fixture.jobs.on_written(fixture.answer(""), fixture.now, fixture.out);
  fixture.jobs.on_command_flag(false, fixture.now, fixture.out);
  fixture.jobs.on_done_flag(false, fixture.now, fixture.out);
  CHECK(fixture.told<Started>().at(0).token == 3);
  // What the program may have already comes to its end first; so does a command.
  for (const MessageType type : {MessageType::information, MessageType::command}) {
    FieldFixture other;
    const bool offered = type == MessageType::information;
    CHECK(other.add(1, type, offered ? "" : std::string(200, 'x')));
    while (!other.jobs.waits_to_be_taken() && !other.jobs.waits_for_chunk()) {
      other.jobs.on_written(other.answer(""), other.now, other.out);
    }
    CHECK(other.add(2, MessageType::command, "7", "reach"));
    CHECK(other.told<Refused>().empty());
    CHECK(other.jobs.runs(1));
  }
}

TEST_CASE("information that the program has not taken for 10 s is dropped, whether it waits or is being written") {
  FieldFixture fixture;
  CHECK(fixture.add(1, MessageType::information, std::string(1000, 'x')));
  CHECK(fixture.add(2, MessageType::information));
  CHECK(fixture.add(3, MessageType::request));
  for (int i = 0; i < 9; ++i) {
    while (!fixture.jobs.waits_for_chunk()) fixture.jobs.on_written(fixture.answer(""), fixture.now, fixture.out);
    fixture.now.mono = fixture.now.mono + seconds(1.1);
    fixture.jobs.check_patience(fixture.now, fixture.out);
    CHECK(fixture.jobs.runs(1));
    CHECK(fixture.jobs.runs(2));
    fixture.jobs.on_chunk_flag(false, fixture.now, fixture.out);
  }
  fixture.now.mono = fixture.now.mono + seconds(0.2);
  fixture.jobs.check_patience(fixture.now, fixture.out);
  CHECK_FALSE(fixture.jobs.runs(1));
  CHECK_FALSE(fixture.jobs.runs(2));
  CHECK(fixture.jobs.runs(3));
  CHECK(std::ranges::count(fixture.outbox.counts, std::string("refused.timeout")) == 2);
  while (!fixture.jobs.waits_to_be_taken()) fixture.jobs.on_written(fixture.answer(""), fixture.now, fixture.out);
}

TEST_CASE("messages that are forgotten at once leave one withdrawal behind, however many they are") {
  FieldFixture fixture;
  fixture.link.ask({C3Purpose::note, "BUSY", std::nullopt, 0}, fixture.now, fixture.out);
  for (Token token = 1; token <= 1000; ++token) {
    REQUIRE(fixture.jobs.add({token, MessageType::command, "wave", "operator", "", ""}, fixture.now, fixture.out));
    fixture.jobs.forget(token, fixture.now, fixture.out);
  }
  CHECK(fixture.jobs.add({2000, MessageType::command, "wave", "operator", "", ""}, fixture.now, fixture.out));
  CHECK(fixture.sent() == "BUSY ");
  fixture.answer("0");
  CHECK(fixture.sent() == "TRB_COMMAND=FALSE ");
  fixture.answer("");
  CHECK(fixture.sent() == "TRB_TYPE[]=\"command\" ");
}

TEST_CASE("all are dropped: what waits is refused, what was answered is not; what is offered is to be cleared") {
  FieldFixture fixture;
  fixture.offer(1);
  fixture.jobs.on_command_flag(false, fixture.now, fixture.out);
  fixture.jobs.on_done_flag(false, fixture.now, fixture.out);
  CHECK(fixture.told<Started>().size() == 1);
  CHECK(fixture.jobs.add({2, MessageType::command, "wave", "operator", "", ""}, fixture.now, fixture.out));
  CHECK_FALSE(fixture.jobs.drop(fail(Errc::fenced, "stopped"), fixture.out));
  const auto refused = fixture.told<Refused>();
  REQUIRE(refused.size() == 1);
  CHECK(refused[0].token == 2);
  fixture.offer(3);
  CHECK(fixture.jobs.drop(fail(Errc::fenced, "stopped"), fixture.out));
}

TEST_CASE("the robot has stopped its program: the skill under way has failed, with the reason") {
  JobsFixture fixture;
  CHECK(fixture.add(1, "reach"));
  fixture.written();
  fixture.written();
  const C3Jobs::Broken broken = fixture.jobs.fail_all(fail(Errc::robot_error, "why"), fixture.out);
  CHECK(broken.moved);
  CHECK_FALSE(broken.offered);
  const auto ended = fixture.told<Ended>();
  REQUIRE(ended.size() == 1);
  CHECK_FALSE(ended[0].well);
  CHECK(ended[0].text == "why");
}
