// The parts of the core that have laws of their own.
#include <doctest/doctest.h>

#include <algorithm>

#include "proto/body.hpp"
#include "proto/message.hpp"
#include "services/scheduler/core/run/certificates.hpp"
#include "services/scheduler/core/run/pending_deliveries.hpp"
#include "services/scheduler/core/run/results.hpp"
#include "services/scheduler/core/view.hpp"
#include "services/scheduler/test/fleet.hpp"

using namespace trb;
using namespace trb::scheduler;

namespace {

HeldResult held(std::uint32_t attempt, TaskOutcome outcome, const std::string& data = "") {
  TaskResult result;
  result.key = {"run", "task", 1, attempt};
  result.outcome = outcome;
  result.data = data;
  return {{"result", "ur3", {encode(result)}, {"signature"}}, result};
}

}  // namespace

TEST_CASE(
    "the first FINISHED result counts, else the latest attempt's; FINISHED is never lost to others of its attempt") {
  ResultSet set;
  CHECK(set.of(0) == nullptr);
  CHECK(set.add(0, held(2, TaskOutcome::failed)));
  CHECK(set.add(0, held(1, TaskOutcome::retriable)));
  CHECK_FALSE(set.add(0, held(1, TaskOutcome::retriable)));
  CHECK(set.of(0)->result.outcome == TaskOutcome::failed);
  CHECK_FALSE(set.has_final(0));
  CHECK(set.add(0, held(1, TaskOutcome::finished)));
  CHECK(set.has_final(0));
  CHECK_FALSE(set.finished_twice(0));
  CHECK(set.add(0, held(1, TaskOutcome::finished, "other")));
  CHECK(set.finished_twice(0));
  CHECK(set.final_tasks(2) == std::vector<bool>{true, false});
  for (const char* data : {"", "a", "b"}) set.add(0, held(1, TaskOutcome::failed, data));
  CHECK(set.finished_twice(0));
}

TEST_CASE("the view of the largest run is a message that its reader takes; a usual one is left whole") {
  const auto make = [](std::size_t tasks, std::size_t decisions) {
    const std::string name(64, 'n');
    RunView view;
    for (std::size_t i = 0; i < tasks; ++i) {
      TaskView task;
      task.id = task.robot = task.skill = task.moved_from = name;
      task.reason = std::string(1024, 'r');
      task.condition = std::string(512, 'c');
      task.after.assign(tasks / 10, static_cast<TaskIndex>(tasks - 1));
      view.tasks.push_back(task);
    }
    for (std::size_t i = 0; i < decisions; ++i) {
      DecisionView decision;
      decision.reason = std::string(1024, 'd');
      decision.tasks.assign(tasks, TaskRuling{name, Ruling::move, name, 1, Evidence::word});
      view.decisions.push_back(decision);
    }
    return view;
  };
  RunView large = make(1000, 64);
  CHECK_FALSE(pack(large).ok());
  fit(large);
  const auto packed = pack(large);
  REQUIRE(packed.ok());
  CHECK(packed->size() <= kMaxDataSize);
  CHECK(large.tasks.size() == 1000);
  CHECK(large.tasks[999].after.size() == 100);
  CHECK(large.decisions.size() == 64);
  RunView usual = make(100, 4);
  const Bytes before = encode(usual);
  fit(usual);
  CHECK(encode(usual) == before);
}

TEST_CASE("what was FINISHED is not SKIPPED, whoever said that first") {
  for (const bool skipped_first : {true, false}) {
    ResultSet set;
    for (const bool skipped : {skipped_first, !skipped_first}) {
      set.add(0, skipped ? held(1, TaskOutcome::skipped) : held(2, TaskOutcome::finished));
    }
    CHECK(set.of(0)->result.outcome == TaskOutcome::finished);
    CHECK_FALSE(set.is_skipped(0));
  }
}

TEST_CASE("of what is not final the latest epoch's counts: who was replaced may have tried on") {
  const auto of_epoch = [](std::uint32_t epoch, std::uint32_t attempt) {
    HeldResult out = held(attempt, TaskOutcome::retriable);
    out.result.epoch = epoch;
    out.result.robot = epoch == 1 ? "ur3" : "drone";
    out.record.payload.bytes = encode(out.result);
    return out;
  };
  ResultSet set;
  set.add(0, of_epoch(1, 3));
  set.add(0, of_epoch(2, 2));
  CHECK(set.of(0)->result.epoch == 2);
  CHECK(set.holds(0, {"run", "task", 1, 2}, "drone"));
  CHECK_FALSE(set.holds(0, {"run", "task", 1, 2}, "ur3"));
}

TEST_CASE("an endless signer fills nothing") {
  ResultSet set;
  for (int i = 0; i < 100; ++i) set.add(0, held(1, TaskOutcome::failed, std::to_string(100 + i)));
  CHECK_FALSE(set.add(0, held(1, TaskOutcome::failed, "150")));
  CHECK(set.add(0, held(2, TaskOutcome::finished)));
  CHECK(set.has_final(0));
}

TEST_CASE("a delivery is sent at once, then after 0.2 s, doubled up to 2 s, until it is settled") {
  PendingDeliveries deliveries;
  deliveries.owe(DeliveryKind::baton, "ur3", {1, 2});
  deliveries.owe(DeliveryKind::baton, "ur3", {1, 2});
  MonotonicTime now{0};
  std::vector<double> times;
  while (now <= MonotonicTime{0} + seconds(6)) {
    CHECK(deliveries.take_due(now).size() == 1);
    times.push_back(to_seconds(now - MonotonicTime{0}));
    CHECK(deliveries.take_due(now).empty());
    now = *deliveries.next();
  }
  const std::vector<double> expected{0, 0.2, 0.6, 1.4, 3.0, 5.0};
  REQUIRE(times.size() == expected.size());
  for (std::size_t i = 0; i < times.size(); ++i) CHECK(times[i] == doctest::Approx(expected[i]));
  CHECK_FALSE(deliveries.settle(DeliveryKind::baton, "ur3", {1}));
  CHECK_FALSE(deliveries.settle(DeliveryKind::baton, "drone", {1, 2}));
  CHECK(deliveries.settle(DeliveryKind::baton, "ur3", {1, 2}));
  CHECK_FALSE(deliveries.settle(DeliveryKind::baton, "ur3", {1, 2}));
  CHECK(deliveries.empty());
}

TEST_CASE("who was sent a thing twice in vain is likely away") {
  BackOff timer;
  for (const bool slow : {false, false, true, true}) {
    CHECK(timer.slow() == slow);
    timer.sent({});
  }
  timer.restart();
  CHECK_FALSE(timer.slow());
}

TEST_CASE("results for a node that is away go together, those for one that answers go alone") {
  PendingDeliveries deliveries;
  deliveries.owe(DeliveryKind::results, "cloud", {0});
  MonotonicTime now{0};
  CHECK(deliveries.take_due(now).size() == 1);
  deliveries.owe(DeliveryKind::results, "cloud", {1});
  CHECK(deliveries.take_due(now)[0].tasks == std::vector<TaskIndex>{1});
  for (int i = 0; i < 8; ++i) {
    now = *deliveries.next();
    deliveries.take_due(now);
  }
  now = *deliveries.next();
  CHECK(deliveries.take_due(now)[0].tasks == std::vector<TaskIndex>{0, 1});
  CHECK(deliveries.settle(DeliveryKind::results, "cloud", {1, 5}));
  CHECK(deliveries.creditors(DeliveryKind::results) == std::vector<std::string>{"cloud"});
}

TEST_CASE("a certificate that was opened once is known; one that differs in a byte is opened by itself, and is wrong") {
  test::Fleet fleet;
  fleet.add("ur3", Role::robot);
  Certificates certificates(fleet.authority());
  const SignedRecord record = fleet["ur3"].certificate;
  CHECK(certificates.open(record)->id == "ur3");
  CHECK(certificates.open(record)->id == "ur3");
  CHECK(certificates.size() == 1);
  for (const bool payload : {true, false}) {
    SignedRecord forged = record;
    Bytes& bytes = payload ? forged.payload.bytes : forged.signature.bytes;
    bytes[bytes.size() / 2] ^= 1;
    CHECK_FALSE(certificates.open(forged).ok());
  }
  CHECK(certificates.size() == 1);
  for (std::size_t i = 0; i < Certificates::kMost; ++i) {
    const std::string id = "r" + std::to_string(i);
    fleet.add(id, Role::robot);
    CHECK(certificates.open(fleet[id].certificate)->id == id);
  }
  CHECK(certificates.size() <= Certificates::kMost);
}
