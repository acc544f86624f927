#include "services/resilience/core/route_requests.hpp"

#include <doctest/doctest.h>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::resilience;

namespace {

/// How many requests are sent at this time.
std::size_t sent(RouteRequests& requests, double s) {
  Outbox out;
  requests.tick("cloud", RouteRequests::kIdle, at(s), out);
  return out.sends.size();
}

RouteTable page_of(const std::string& robot, const std::string& after, bool more) {
  RouteTable out{"cloud", {}, more, after};
  out.routes.emplace_back().id = robot;
  return out;
}

}  // namespace

TEST_CASE("nothing is requested before a table is wanted; the first request is sent at once") {
  RouteRequests requests;
  CHECK_FALSE(requests.next_deadline());
  CHECK(sent(requests, 0) == 0);
  requests.want(at(1), RouteRequests::kWhileOpen);
  CHECK(requests.next_deadline() == at(1).mono);
  CHECK(sent(requests, 1) == 1);
  CHECK(sent(requests, 1) == 0);
}

TEST_CASE("a request follows the one before after its pause, or later when nobody wants a table") {
  RouteRequests requests;
  requests.want(at(0), RouteRequests::kAtOnce);
  CHECK(sent(requests, 0) == 1);
  CHECK(requests.next_deadline() == at(30).mono);
  requests.want(at(2), RouteRequests::kWhileOpen);
  CHECK(requests.next_deadline() == at(5).mono);
  requests.want(at(2), RouteRequests::kAtOnce);
  CHECK(requests.next_deadline() == at(2).mono);
  CHECK(sent(requests, 2) == 1);
  CHECK(sent(requests, 31.9) == 0);
  CHECK(sent(requests, 32) == 1);
}

TEST_CASE("a report is followed by two tables: the first may be from before the profile that tells the same") {
  RouteRequests requests;
  requests.want_with_next(at(0));
  CHECK(sent(requests, 0) == 1);
  CHECK(requests.next_deadline() == at(1).mono);
  CHECK(sent(requests, 1) == 1);
  CHECK(requests.next_deadline() == at(31).mono);
}

TEST_CASE("the table is whole once its last page has come") {
  RouteRequests requests;
  Outbox out;
  CHECK_FALSE(requests.receive(page_of("a", "", true), "cloud", out));
  REQUIRE(out.sends.size() == 1);
  const auto* next = get_if<RouteListRequest>(&out.sends[0].body);
  REQUIRE(next != nullptr);
  CHECK(next->after == "a");
  const auto table = requests.receive(page_of("b", "a", false), "cloud", out);
  REQUIRE(table);
  CHECK(table->routes.size() == 2);
  CHECK(out.sends.size() == 1);
}
