// What others on the network may say to the resilience, and how much of it.
#include <doctest/doctest.h>

#include "proto/message.hpp"
#include "services/resilience/core/alert_book.hpp"
#include "services/resilience/test/bench.hpp"

using namespace trb;
using namespace trb::resilience;
using namespace trb::resilience::test;

TEST_CASE("another node's Nack refuses no decision: the own scheduler alone can") {
  auto bench = paper();
  bench->fault("ridgeback", "mobile");
  bench->end_task("t4", TaskOutcome::failed, "mobile is broken");
  const std::string id = bench->alert().id;
  bench->deaf = true;
  CHECK(bench->decide(Verdict::skip) == "accepted");
  CHECK(bench->heard["run_decision"] == 1);
  bench->say("pioneer1", Nack{"conflict", "run_decision", "cloud", "not so", ""});
  CHECK(bench->any(id).state == AlertState::releasing);
  bench->deaf = false;
  bench->wait(seconds(10));
  CHECK(bench->any(id).state == AlertState::decided);
  CHECK(bench->taken.size() == 1);
}

TEST_CASE(
    "however many alerts are open and whoever could help: the table fits into a message, nothing open is missing") {
  AlertBook book;
  for (int i = 0; i < 256; ++i) {
    Alert alert;
    alert.run = kRun;
    alert.robot = "robot" + std::to_string(i);
    alert.time = i;
    for (int t = 0; t < 9; ++t) alert.tasks.push_back("task" + std::to_string(t));
    for (int p = 0; p < 64; ++p) {
      Proposal one{"taker" + std::to_string(p), {}, 1.0 / 64, {}, ""};
      for (const std::string& task : alert.tasks) one.tasks.push_back({task, one.robot});
      for (const char* name : {"battery", "distance", "availability"}) one.parts.push_back({name, 80, "%", 0.3, 0.1});
      alert.proposals.push_back(one);
      alert.unfit.push_back({one.robot, std::string(200, 'x')});
    }
    REQUIRE(book.add(alert) != nullptr);
  }
  const AlertTable table = book.table(false);
  CHECK(encode(table).size() <= kMaxDataSize);
  CHECK(table.alerts.size() == 256);
  CHECK(table.alerts.front().robot == "robot255");
}

TEST_CASE("robots that tell of very many faults leave room for the alerts of runs") {
  AlertBook book;
  const auto add = [&](const std::string& run, int i) {
    Alert alert;
    alert.run = run;
    alert.robot = "robot" + std::to_string(i);
    return book.add(alert) != nullptr;
  };
  for (int i = 0; i < 500; ++i) CHECK(add("", i) == (i < static_cast<int>(AlertBook::kMaxLone)));
  CHECK(add(kRun, 0));
}
