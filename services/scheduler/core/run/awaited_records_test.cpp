#include "services/scheduler/core/run/awaited_records.hpp"

#include <doctest/doctest.h>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::scheduler;

TEST_CASE("results are asked of whoever was first said to hold them, with back-off") {
  AwaitedRecords awaited;
  awaited.need_result(1, "drone", "cloud");
  awaited.need_result(1, "pioneer", "cloud");
  awaited.need_result(2, "pioneer", "cloud");
  const auto first = awaited.take_due_results(at(0).mono);
  CHECK(first.at("drone") == std::vector<TaskIndex>{1});
  CHECK(first.at("pioneer") == std::vector<TaskIndex>{2});
  CHECK(awaited.take_due_results(at(0.1).mono).empty());
  CHECK(awaited.take_due_results(at(0.2).mono).size() == 2);
  CHECK_FALSE(awaited.has_answered("pioneer", 2));
  awaited.settle_without_result("pioneer", at(0.3).mono);
  CHECK(awaited.has_answered("pioneer", 2));
  CHECK_FALSE(awaited.has_answered("pioneer", 1));
  CHECK(awaited.take_due_results(at(10).mono).size() == 1);
  awaited.drop_result(1);
  CHECK_FALSE(awaited.needs_results());
}

TEST_CASE("who says that he holds a result and never answers keeps nobody from asking the judge") {
  AwaitedRecords awaited;
  awaited.need_result(1, "drone", "cloud");
  awaited.take_due_results(at(0).mono);
  awaited.need_result(1, "cloud", "cloud");
  CHECK(awaited.take_due_results(at(0).mono).at("cloud") == std::vector<TaskIndex>{1});
  awaited.need_result(1, "drone", "cloud");
  CHECK_FALSE(awaited.take_due_results(at(10).mono).contains("drone"));
  awaited.need_result(1, "cloud", "cloud");  // it keeps its back-off
  CHECK(awaited.take_due_results(at(10.1).mono).empty());
}

TEST_CASE("who says that he holds a result and never answers keeps nobody from asking the next who says so") {
  AwaitedRecords awaited;
  awaited.need_result(1, "drone", "cloud");
  awaited.need_result(1, "pioneer", "cloud");
  awaited.need_result(1, "belt", "cloud");
  const auto asked = [&](double from_s, double until_s) {
    std::set<std::string> out;
    for (double s = from_s; s < until_s; s += 0.1) {
      for (const auto& [giver, tasks] : awaited.take_due_results(at(s).mono)) out.insert(giver);
    }
    return out;
  };
  CHECK(asked(0, 1) == std::set<std::string>{"drone"});
  CHECK(asked(1, 20) == std::set<std::string>{"belt", "drone", "pioneer"});
  // Each of them comes again and again.
  CHECK(asked(20, 40) == std::set<std::string>{"belt", "drone", "pioneer"});
  // Who answers that it holds none is asked no more; the others are.
  awaited.need_result(2, "drone", "cloud");
  awaited.need_result(2, "pioneer", "cloud");
  awaited.drop_result(1);
  awaited.take_due_results(at(40).mono);
  awaited.settle_result(2, "drone");
  CHECK(asked(41, 60) == std::set<std::string>{"pioneer"});
  awaited.settle_result(2, "pioneer");
  CHECK_FALSE(awaited.needs_results());
}

TEST_CASE("an answer without a result is about what every request asked for that it may answer") {
  AwaitedRecords awaited;
  awaited.need_result(1, "cloud", "cloud");
  awaited.take_due_results(at(0).mono);
  awaited.need_result(2, "cloud", "cloud");
  CHECK(awaited.take_due_results(at(0.1).mono).at("cloud") == std::vector<TaskIndex>{1, 2});
  awaited.settle_without_result("cloud", at(0.2).mono);
  CHECK(awaited.has_answered("cloud", 1));
  CHECK_FALSE(awaited.has_answered("cloud", 2));
  awaited.settle_without_result("cloud", at(29.9).mono);
  CHECK_FALSE(awaited.has_answered("cloud", 2));
  awaited.settle_without_result("cloud", at(30).mono);
  CHECK(awaited.has_answered("cloud", 2));
}

TEST_CASE("what was never asked for is not answered") {
  AwaitedRecords awaited;
  awaited.need_result(1, "cloud", "cloud");
  awaited.settle_without_result("cloud", at(60).mono);
  CHECK_FALSE(awaited.has_answered("cloud", 1));
  awaited.settle_result(1, "drone");
  CHECK_FALSE(awaited.has_answered("drone", 1));
  awaited.settle_result(1, "cloud");
  CHECK(awaited.has_answered("cloud", 1));
}

TEST_CASE("decisions are taken only from whom they were asked, once") {
  AwaitedRecords awaited;
  awaited.await_decisions("cloud");
  CHECK_FALSE(awaited.settle_decisions("drone"));
  CHECK(awaited.settle_decisions("cloud"));
  CHECK_FALSE(awaited.settle_decisions("cloud"));
}

TEST_CASE("the judge is asked for the end after 30 s, then more rarely, and anew when there was something to do") {
  AwaitedRecords awaited;
  CHECK_FALSE(awaited.end_is_due(at(0).mono));
  CHECK(awaited.next() == at(30).mono);
  CHECK(awaited.end_is_due(at(30).mono));
  CHECK_FALSE(awaited.end_is_due(at(60).mono));
  CHECK(awaited.end_is_due(at(90).mono));
  awaited.drop_end();
  CHECK_FALSE(awaited.end_is_due(at(100).mono));
  CHECK(awaited.end_is_due(at(130).mono));
}
