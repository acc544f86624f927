#include "services/scheduler/core/run/short_form.hpp"

#include <doctest/doctest.h>

#include <limits>
#include <random>

#include "common/base/varint.hpp"
#include "proto/body.hpp"
#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

TaskResult usual(const KnownRun& known, const std::string& task, const std::string& robot) {
  TaskResult out;
  out.key = {kKnownRun, task, 1, 1};
  out.digest = known.run().definition().start().digest;
  out.robot = robot;
  out.outcome = TaskOutcome::finished;
  out.started = known.run().definition().start().created + 300'000'000'000;
  out.ended = out.started + 3'012'345'678;
  out.duration_s = 3.011'222'333;
  return out;
}

SignedRecord sign(const KnownRun& known, const TaskResult& result) {
  return known.signers.sign(result.robot, kSignedResult, encode(result));
}

/// Shortened, as bytes and back, and made whole again.
template <class Message>
Message travelled(Message message, const RunDefinition& definition) {
  shorten(message, definition);
  const auto whole = lengthened(*decode<Message>(encode(message)), definition);
  REQUIRE(whole);
  return *whole;
}

Results results_of(std::vector<SignedRecord> records) {
  return {kKnownRun, std::move(records), {}};
}

}  // namespace

TEST_CASE("a result comes back byte for byte, in a third of its bytes") {
  const KnownRun known{chain({"drone", "ur3", "pioneer"})};
  const RunDefinition& definition = known.run().definition();
  const Results whole = results_of({sign(known, usual(known, "task-1", "ur3"))});
  CHECK(encode(travelled(whole, definition)) == encode(whole));
  Results shorter = whole;
  shorten(shorter, definition);
  CHECK(shorter.results.empty());
  CHECK(encode(shorter).size() < 110);
  CHECK(encode(whole).size() > 220);
  CHECK(tag_of(shorter.short_form) == definition.tag());
}

TEST_CASE("whatever a robot reports of an attempt comes back") {
  const KnownRun known{chain({"drone", "ur3", "pioneer"})};
  constexpr auto kFirst = std::numeric_limits<std::int64_t>::min();
  constexpr auto kLast = std::numeric_limits<std::int64_t>::max();
  std::mt19937_64 random(7);
  for (int i = 0; i < 500; ++i) {
    TaskResult result = usual(known, "task-" + std::to_string(i % 3), i % 2 == 0 ? "ur3" : "cloud2");
    result.outcome = static_cast<TaskOutcome>(i % 7);
    result.goes_on = i % 5 == 0;
    result.key.attempt = static_cast<std::uint32_t>(random() >> (32 + random() % 32));
    result.epoch = static_cast<std::uint32_t>(random() >> (32 + random() % 32));
    if (i % 3 == 0) result.reason = std::string(random() % 300, 'r');
    if (i % 4 == 0) result.data = std::string(random() % 300, 'd');
    if (i % 11 == 0) result.started = i % 2 == 0 ? kFirst : kLast;
    if (i % 13 == 0) result.ended = i % 2 == 0 ? kFirst : kLast;
    if (i % 2 == 0) result.duration_s = static_cast<double>(random()) / static_cast<double>(1U + random() % 1'000'000);
    if (i % 17 == 0) result.duration_s = -0.0;
    const Results whole = results_of({sign(known, result)});
    CAPTURE(i);
    CHECK(encode(travelled(whole, known.run().definition())) == encode(whole));
    Results shorter = whole;
    shorten(shorter, known.run().definition());
    CHECK(shorter.results.empty());
  }
}

TEST_CASE("a baton comes back with its bitmaps, whichever form is shorter") {
  const KnownRun known{chain(std::vector<std::string>(40, "ur3"))};
  const RunDefinition& definition = known.run().definition();
  std::vector<bool> first(40, false), mixed(40, false), all(40, true);
  std::fill(first.begin(), first.begin() + 33, true);
  for (std::size_t i = 0; i < mixed.size(); i += 2) mixed[i] = true;
  for (const auto& final_tasks : {first, mixed, all, std::vector<bool>(40, false)}) {
    Baton baton;
    baton.run = kKnownRun;
    baton.digest = definition.start().digest;
    baton.epoch = 3;
    baton.final_tasks.bytes = to_bitmap(final_tasks);
    baton.skipped_tasks.bytes = to_bitmap(mixed);
    baton.tasks = {4, 5};
    baton.results = {sign(known, usual(known, "task-3", "ur3"))};
    CHECK(encode(travelled(baton, definition)) == encode(baton));
  }
}

TEST_CASE("a record that would not come back keeps its long form") {
  const KnownRun known{chain({"drone", "ur3", "pioneer"})};
  const RunDefinition& definition = known.run().definition();
  const TaskResult result = usual(known, "task-1", "ur3");
  TaskResult other_run = result;
  other_run.key.run = std::string(32, 'b');
  TaskResult no_task = result;
  no_task.key.task = "task-9";
  TaskResult later_member = result;
  later_member.robot = "somebody";
  SignedRecord newer = sign(known, result);  // as a later version may write it: one more element
  newer.payload.bytes[0] = static_cast<char>(newer.payload.bytes[0] + 1);
  newer.payload.bytes += '\x07';
  SignedRecord other_kind = sign(known, result);
  other_kind.kind = "choice";
  SignedRecord cut = sign(known, result);
  cut.signature.bytes.pop_back();
  SignedRecord none{"result", "ur3", {"x"}, {Bytes(64, 's')}};
  const SignedRecord by_nobody{"result", "somebody", {encode(later_member)}, {Bytes(64, 's')}};
  const Results whole = results_of(
      {sign(known, other_run), sign(known, no_task), by_nobody, newer, other_kind, cut, none, sign(known, result)});
  Results shorter = whole;
  shorten(shorter, definition);
  CHECK(shorter.results.size() == 7);
  CHECK(travelled(whole, definition).results == whole.results);
}

/// A usual result in short form, to be falsified.
struct ShortResult {
  ShortResult() { shorten(results, definition); }

  KnownRun known{chain({"drone", "ur3", "pioneer"})};
  const RunDefinition& definition = known.run().definition();
  Results results = results_of({sign(known, usual(known, "task-1", "ur3"))});
};

TEST_CASE("what is cut, or names no task or robot, is refused") {
  ShortResult one;
  const RunDefinition& definition = one.definition;
  Results& shorter = one.results;
  const Bytes form = shorter.short_form.bytes;
  for (std::size_t size = RunDefinition::kTagSize + 1; size < form.size(); ++size) {
    shorter.short_form.bytes = form.substr(0, size);
    CHECK_FALSE(lengthened(shorter, definition).ok());
  }
  const auto code_of = [&](const Bytes& behind) {
    shorter.short_form.bytes = definition.tag() + behind;
    return lengthened(shorter, definition).error().code;
  };
  CHECK(code_of(Bytes("\x03\x00", 2)) == Errc::bad_value);
  CHECK(code_of(Bytes("\x00\x63", 2)) == Errc::bad_value);
  CHECK(code_of(Bytes("\x00\x00\x0f", 3)) == Errc::bad_value);
  Baton baton;
  for (const Bytes& behind : {Bytes(""), Bytes("\x01\x09"), Bytes("\x01\x02\x01\x03"), Bytes("\x01\x01\x7f"),
                              Bytes("\xff\xff\xff\xff\x7f\x00\x00", 7)}) {
    baton.short_form.bytes = definition.tag() + behind;
    CHECK(lengthened(baton, definition).error().code == Errc::malformed);
  }
}

TEST_CASE("an attempt or epoch of more than 32 bits is refused, and never another one") {
  ShortResult one;
  const RunDefinition& definition = one.definition;
  Results& shorter = one.results;
  const Bytes form = shorter.short_form.bytes;
  const std::size_t bits = RunDefinition::kTagSize + 2;  // behind the numbers of task and robot
  const auto is_read = [&](std::uint64_t attempt, std::uint64_t epoch) {
    Bytes& later = shorter.short_form.bytes;
    later = form.substr(0, bits) + static_cast<char>(form[bits] | 0x40);
    put_varint(later, attempt);
    put_varint(later, epoch);
    later += form.substr(bits + 1);
    return lengthened(shorter, definition).ok();
  };
  CHECK(is_read(2, UINT32_MAX));
  CHECK_FALSE(is_read(1ULL << 32U, 1));
  CHECK_FALSE(is_read(1, 1ULL << 32U));
}
