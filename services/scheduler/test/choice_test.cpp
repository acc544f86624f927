// A condition is evaluated once, whatever dies, is lost or is forged meanwhile.
#include "services/scheduler/test/condition_story.hpp"
#include "services/scheduler/test/crashes.hpp"
#include "services/scheduler/test/forged.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

/// A fleet in which ur3 knows the run of left_or_right and that `bring` is done, but has been told of no choice.
struct Unchosen : Story {
  Unchosen() {
    start = fleet.make_start(left_or_right(), "cloud", seconds(3600), kRun);
    fleet.stop("ridgeback");
    fleet.ask("cloud", MessageType::command, RunSubmit{start});
    TaskResult result;
    result.key = {kRun, "bring", 1, 1};
    result.digest = decode<RunStart>(start.payload.bytes)->digest;
    result.robot = "ridgeback";
    result.outcome = TaskOutcome::finished;
    baton = {kRun, result.digest, 1, {"\x01"}, {fleet.sign("ridgeback", kSignedResult, encode(result))}, {1, 2}, {},
             {}};
    pass({});
    fleet.tell("ur3", "ridgeback", MessageType::information, Definition{start}, 99);
    fleet.pass(seconds(1));
  }

  Outbox pass(std::vector<SignedRecord> choices) {
    Baton with = baton;
    with.choices = std::move(choices);
    return fleet.tell("ur3", "ridgeback", MessageType::command, with);
  }

  Choice choice(double degrees) const {
    Choice out{kRun, baton.digest, 1, "ridgeback", {}, "conveyor", {}, 5};
    out.reading = {"temperature", "", "degC", false, degrees, "", 1, 0, "good", 0, 0};
    out.tasks = {{"left", 1, degrees <= 20}, {"right", 1, degrees > 20}};
    return out;
  }

  SignedRecord signed_by(const std::string& who, const std::function<void(Choice&)>& change = {}) const {
    Choice out = choice(25);
    if (change) change(out);
    return fleet.sign(who, kSignedChoice, encode(out));
  }

  SignedRecord start;
  Baton baton;
};

}  // namespace

TEST_CASE("tasks of different robots go by one reading: 19.9 and 20.1 never run both, nor neither") {
  for (const bool first : {false, true}) {
    Story story;
    const std::vector<double> values = first ? std::vector<double>{19.9, 20.1} : std::vector<double>{20.1, 19.9};
    FakeSensor& sensor = story.fleet["conveyor"].sensors.plug("temperature", values);
    story.submit(left_or_right("ur3", "drone"));
    REQUIRE(story.finishes());
    CHECK(sensor.asked == 1);
    story.check_one_branch();
    story.check_one_verdict_each();
    CHECK(story.begun().contains(first ? "left" : "right"));
  }
}

TEST_CASE("whoever evaluates, goes by it or keeps it may die at any record, and there is one verdict") {
  die_at_every_record({"ridgeback", "ur3", "drone", "pioneer", "cloud"}, 100, [](const auto& victim, const Doom& doom) {
    Story story;
    story.fleet["conveyor"].sensors.plug("temperature", {19.9, 20.1, 19.8, 20.2});
    doom(story.fleet);
    story.submit(left_or_right("ur3", "drone"));
    REQUIRE(story.finishes());
    story.check_one_branch();
    story.check_one_verdict_each();
    story.fleet.pass(seconds(10));
    return story.fleet[victim].crash.commits;
  });
}

TEST_CASE("whoever evaluates may die between its question and its record: it asks again, nothing was said") {
  std::size_t asked_twice = 0;
  for (int ms = 0; ms < 40; ++ms) {
    CAPTURE(ms);
    Story story;
    FakeSensor& sensor = story.fleet["conveyor"].sensors.plug("temperature", {19.9, 20.1});
    story.submit(left_or_right("ur3", "drone"));
    REQUIRE(story.fleet.until([&] { return story.seen("bring", "ridgeback").state == TaskState::finished; }));
    story.fleet.pass(std::chrono::milliseconds(ms));
    story.fleet.stop("ridgeback");
    story.fleet.pass(std::chrono::milliseconds(ms % 3));  // what was on its way may meet the new process
    story.fleet.start("ridgeback");
    REQUIRE(story.finishes());
    story.check_one_branch();
    story.check_one_verdict_each();
    asked_twice += sensor.asked == 2 ? 1 : 0;
  }
  CHECK(asked_twice > 5);
}

TEST_CASE("loss, repetition and disorder do no harm to a choice") {
  for (std::uint64_t seed = 1; seed <= 10; ++seed) {
    CAPTURE(seed);
    Story story(seed);
    story.fleet["conveyor"].sensors.plug("temperature", {19.9, 20.1, 19.8, 20.2, 19.7, 20.3});
    story.fleet.weather = {300, 200, 150, seconds(0.8)};
    story.fleet["ridgeback"].crash.at = seed % 5 + 1;
    story.submit(left_or_right("ur3", "drone"));
    REQUIRE(story.finishes());
    story.check_one_branch();
    story.check_one_verdict_each();
  }
}

TEST_CASE("with the cloud gone the robots choose, and it learns of choice and reading when it is back") {
  Story story;
  story.fleet["conveyor"].sensors.plug("temperature", {25.1});
  story.submit(left_or_right(), "ridgeback");
  story.fleet.stop("cloud");
  REQUIRE(story.fleet.until([&] { return story.begun().contains("back"); }));
  story.fleet.start("cloud");
  REQUIRE(story.finishes());
  CHECK(story.seen("left").reason == "temperature of conveyor was 25.1 degC, not <= 20");
  CHECK(story.seen("right").condition == "temperature of conveyor was 25.1 degC, > 20");
  story.check_one_verdict_each();
}

TEST_CASE("a choice is journaled before anything follows from it, and its repetition is acknowledged again") {
  Unchosen story;
  CHECK(story.fleet["ur3"].adapter.commanded.empty());
  const Outbox out = story.pass({story.signed_by("ridgeback")});
  CHECK(sent<BatonJournaled>(out).size() == 1);
  REQUIRE(out.journal.size() == 2);
  CHECK(std::any_cast<JournalChoice>(&out.journal[0].record) != nullptr);
  CHECK(std::any_cast<JournalStart>(&out.journal[1].record) != nullptr);
  REQUIRE(sent<Execute>(out).size() == 1);
  CHECK(sent<Execute>(out)[0].key.task == "right");
  REQUIRE(sent<SignRequest>(out).size() == 1);
  const Bytes skip = sent<SignRequest>(out)[0].payload.bytes;
  CHECK(decode<TaskResult>(skip)->outcome == TaskOutcome::skipped);
  const Outbox again = story.pass({story.signed_by("ridgeback")});
  CHECK(sent<BatonJournaled>(again).size() == 1);
  CHECK(again.journal.empty());
  CHECK(std::ranges::count(again.counts, "double_choice") == 0);
  // The other branch's result is signed while this one's task is under way.
  const SignedRecord record = story.fleet.sign("ur3", kSignedResult, skip);
  const Outbox kept = story.fleet.tell("ur3", "ur3", MessageType::information, record);
  REQUIRE(kept.journal.size() == 1);
  CHECK(std::any_cast<JournalResult>(&kept.journal[0].record) != nullptr);
  CHECK(story.seen("left", "ur3").state == TaskState::skipped);
  const Execute right = sent<Execute>(out)[0];
  const Outbox ended = story.fleet.tell("ur3", "ur3", MessageType::information,
                                        Outcome{right.key, right.instance, TaskOutcome::finished, "", "", 1});
  REQUIRE(sent<SignRequest>(ended).size() == 1);
  CHECK(decode<TaskResult>(sent<SignRequest>(ended)[0].payload.bytes)->key.task == "right");
}

TEST_CASE("a second choice that says otherwise changes nothing, and is told") {
  Unchosen story;
  story.pass({story.signed_by("ridgeback")});
  const SignedRecord other = story.fleet.sign("ridgeback", kSignedChoice, encode(story.choice(15)));
  const Outbox out = story.pass({other});
  CHECK(out.journal.empty());
  CHECK(sent<Execute>(out).empty());
  CHECK(std::count(out.counts.begin(), out.counts.end(), "double_choice") == 2);
  CHECK(story.seen("left", "ur3").condition == "temperature of conveyor was 25 degC, not <= 20");
}

TEST_CASE("a forged choice, or another's, is refused and leaves no trace") {
  Unchosen story;
  const auto refused = [&](const SignedRecord& record) {
    const Outbox out = story.pass({record});
    CHECK(out.journal.empty());
    CHECK(sent<BatonJournaled>(out).empty());
    CHECK(sent<Execute>(out).empty());
    return nack_of(out);
  };
  check_forged(story.signed_by("ridgeback"), kSignedResult, refused);
  CHECK(refused(story.signed_by("ur3", [](Choice& is) { is.by = "ur3"; })) == "not_permitted");
  CHECK(refused(story.signed_by("cloud", [](Choice& is) { is.by = "cloud"; })) == "not_permitted");
  CHECK(refused(story.signed_by("ur3")) == "source_mismatch");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.digest.bytes[0] ^= 1; })) == "conflict");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.run[0] = 'b'; })) == "conflict");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.epoch = 2; })) == "conflict");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.tasks.clear(); })) == "bad_value");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.tasks[0].task = "bring"; })) == "bad_value");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.tasks[0].task = "no"; })) == "bad_value");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.tasks[0].iteration = 2; })) == "bad_value");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.tasks[0].holds = true; })) == "bad_value");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.reading.unit = "K"; })) == "bad_value");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.reading.quality = "stale"; })) == "bad_value");
  CHECK(refused(story.signed_by("ridgeback", [](Choice& is) { is.node = "drone"; })) == "bad_value");
}

TEST_CASE("only whoever chooses tells what a condition waits for") {
  Unchosen story;
  const auto tell = [&](const std::string& who) {
    const TaskProgress progress{{kRun, "left", 1, 1}, who, TaskState::waiting, "rain"};
    story.fleet.tell("cloud", who, MessageType::information, progress);
    return story.view().waits_for;
  };
  CHECK(tell("ur3").empty());
  CHECK(tell("ridgeback") == "rain");
}
