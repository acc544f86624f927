#include "services/scheduler/core/run/pending_requests.hpp"

#include <doctest/doctest.h>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::scheduler;

TEST_CASE("results are asked of whoever was first said to hold them, with back-off") {
  PendingRequests requests;
  requests.need_result(1, "drone");
  requests.need_result(1, "pioneer");
  requests.need_result(2, "pioneer");
  const auto first = requests.take_due_results(at(0).mono);
  CHECK(first.at("drone") == std::vector<TaskIndex>{1});
  CHECK(first.at("pioneer") == std::vector<TaskIndex>{2});
  CHECK(requests.take_due_results(at(0.1).mono).empty());
  CHECK(requests.take_due_results(at(0.2).mono).size() == 2);
  CHECK_FALSE(requests.has_told("pioneer", 2));
  requests.settle_without_result("pioneer", at(0.3).mono);
  CHECK(requests.has_told("pioneer", 2));
  CHECK_FALSE(requests.has_told("pioneer", 1));
  CHECK(requests.take_due_results(at(10).mono).size() == 1);
  requests.drop_result(1);
  CHECK_FALSE(requests.needs_results());
}

TEST_CASE("an answer without a result is about what every request asked for that it may answer") {
  PendingRequests requests;
  requests.need_result(1, "cloud");
  requests.take_due_results(at(0).mono);
  requests.need_result(2, "cloud");
  CHECK(requests.take_due_results(at(0.1).mono).at("cloud") == std::vector<TaskIndex>{1, 2});
  requests.settle_without_result("cloud", at(0.2).mono);
  CHECK(requests.has_told("cloud", 1));
  CHECK_FALSE(requests.has_told("cloud", 2));
  requests.settle_without_result("cloud", at(29.9).mono);
  CHECK_FALSE(requests.has_told("cloud", 2));
  requests.settle_without_result("cloud", at(30).mono);
  CHECK(requests.has_told("cloud", 2));
}

TEST_CASE("what was never asked for is not answered") {
  PendingRequests requests;
  requests.need_result(1, "cloud");
  requests.settle_without_result("cloud", at(60).mono);
  CHECK_FALSE(requests.has_told("cloud", 1));
  requests.settle_result(1, "drone");
  CHECK_FALSE(requests.has_told("drone", 1));
  requests.settle_result(1, "cloud");
  CHECK(requests.has_told("cloud", 1));
}

TEST_CASE("decisions are taken only from whom they were asked, once") {
  PendingRequests requests;
  requests.await_decisions("cloud");
  CHECK_FALSE(requests.settle_decisions("drone"));
  CHECK(requests.settle_decisions("cloud"));
  CHECK_FALSE(requests.settle_decisions("cloud"));
}

TEST_CASE("the judge is asked for the end after 30 s, then more rarely, and anew when there was something to do") {
  PendingRequests requests;
  CHECK_FALSE(requests.end_is_due(at(0).mono));
  CHECK(requests.next() == at(30).mono);
  CHECK(requests.end_is_due(at(30).mono));
  CHECK_FALSE(requests.end_is_due(at(60).mono));
  CHECK(requests.end_is_due(at(90).mono));
  requests.drop_end();
  CHECK_FALSE(requests.end_is_due(at(100).mono));
  CHECK(requests.end_is_due(at(130).mono));
}
