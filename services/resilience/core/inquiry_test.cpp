#include "services/resilience/core/inquiry.hpp"

#include <doctest/doctest.h>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::resilience;

TEST_CASE("an inquiry is complete once the last answer that it waits for has come") {
  Inquiry inquiry;
  CHECK_FALSE(inquiry.has_begun());
  REQUIRE(inquiry.begin(at(0)));
  inquiry.await("r1", "battery");
  inquiry.await("r2", "battery");
  CHECK(inquiry.awaited_robot(seconds(5), at(1)) == "r1");
  CHECK_FALSE(inquiry.on_answer("r1", "battery"));
  CHECK_FALSE(inquiry.on_answer("r3", "battery"));  // was not requested
  CHECK_FALSE(inquiry.is_complete());
  CHECK(inquiry.on_answer("r2", "battery"));
  CHECK(inquiry.is_complete());
  CHECK_FALSE(inquiry.on_answer("r2", "battery"));
  CHECK(inquiry.awaited_robot(seconds(5), at(1)).empty());
}

TEST_CASE("robots are asked again after five seconds, and waited for as long as the patience lasts") {
  Inquiry inquiry;
  REQUIRE(inquiry.begin(at(0)));
  inquiry.await("r1", "battery");
  CHECK_FALSE(inquiry.begin(at(4.9)));
  CHECK(inquiry.awaited_robot(seconds(2), at(1.9)) == "r1");
  CHECK(inquiry.awaited_robot(seconds(2), at(2)).empty());
  CHECK(inquiry.takes_answers(at(5)));
  CHECK_FALSE(inquiry.takes_answers(at(5.1)));
  CHECK(inquiry.begin(at(5)));
  CHECK(inquiry.is_complete());
}

TEST_CASE("values that come in a crowd are followed together, 0.1 s after the first") {
  Inquiry inquiry;
  CHECK_FALSE(inquiry.follow_at());
  inquiry.on_value(at(1));
  inquiry.on_value(at(1.05));
  CHECK(inquiry.has_new_values());
  CHECK(inquiry.follow_at() == at(1.1).mono);
  inquiry.on_followed();
  CHECK_FALSE(inquiry.follow_at());
}

TEST_CASE("a ranking follows every value that has come, and the next one waits five seconds") {
  Inquiry inquiry;
  CHECK(inquiry.may_rank(at(0)));
  inquiry.on_value(at(0));
  inquiry.on_ranked(at(1));
  CHECK_FALSE(inquiry.has_new_values());
  CHECK_FALSE(inquiry.may_rank(at(5.9)));
  CHECK(inquiry.may_rank(at(6)));
}
