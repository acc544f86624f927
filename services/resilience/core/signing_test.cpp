#include "services/resilience/core/signing.hpp"

#include <doctest/doctest.h>

#include "tests/support/at.hpp"

using namespace trb;
using namespace trb::resilience;

namespace {

SignedRecord record_of(const std::string& payload) {
  SignedRecord out;
  out.payload.bytes = payload;
  return out;
}

}  // namespace

TEST_CASE("what was to be signed is signed; another record is not taken") {
  Signing signing;
  CHECK_FALSE(signing.on_signed(record_of("decision")));
  signing.prepare("decision", 3);
  CHECK(signing.is_under_way());
  CHECK_FALSE(signing.on_signed(record_of("another")));
  REQUIRE(signing.on_signed(record_of("decision")));
  CHECK(signing.record());
  CHECK(signing.epoch() == 3);
  CHECK(signing.payload().empty());
  CHECK(signing.is_under_way());
  CHECK_FALSE(signing.on_signed(record_of("decision")));
}

TEST_CASE("each step is tried again by itself, later and later") {
  Signing signing;
  CHECK(signing.try_release(at(0)));
  CHECK_FALSE(signing.try_release(at(0.1)));
  CHECK(signing.try_sign(at(0.1)));
  CHECK(signing.next(at(0.1)) == at(0.2).mono);
  CHECK(signing.try_release(at(0.2)));
  CHECK(signing.next(at(0.2)) == at(0.3).mono);
  CHECK_FALSE(signing.next(at(100)));
}

TEST_CASE("a record that was sent awaits its answer until it is sent again") {
  Signing signing;
  signing.restore(record_of("decision"), 2);
  CHECK_FALSE(signing.was_handed());
  CHECK_FALSE(signing.awaits_answer(at(0)));
  CHECK(signing.try_hand(at(0)));
  CHECK(signing.was_handed());
  CHECK(signing.awaits_answer(at(0.1)));
  CHECK_FALSE(signing.awaits_answer(at(0.2)));
}

TEST_CASE("a verdict waits from its first moment on") {
  Signing signing;
  CHECK_FALSE(signing.has_waited(Duration{0}, at(0)));
  signing.begin(at(1));
  signing.begin(at(3));
  CHECK_FALSE(signing.has_waited(seconds(5), at(5.9)));
  CHECK(signing.has_waited(seconds(5), at(6)));
}
