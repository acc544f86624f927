#include "services/scheduler/core/run/orders.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::scheduler;

namespace {

PauseOrder order(std::uint32_t number, bool paused, std::vector<std::string> doubles = {}) {
  return {"run", number, paused, "cloud", "", 1, std::move(doubles)};
}

SignedRecord record(const char* kind) {
  return {kind, "cloud", {"payload"}, {"signature"}};
}

}  // namespace

TEST_CASE("the order of the higher number counts; of two alike the one that holds") {
  Orders orders;
  CHECK(orders.is_newer(order(1, false)));
  orders.adopt(record("pause"), order(2, false));
  CHECK_FALSE(orders.is_held());
  CHECK_FALSE(orders.is_newer(order(1, true)));
  CHECK_FALSE(orders.is_newer(order(2, false)));
  CHECK(orders.is_newer(order(2, true)));
  orders.adopt(record("pause"), order(2, true));
  CHECK(orders.is_held());
  CHECK_FALSE(orders.goes_on());
  CHECK(orders.is_open());
}

TEST_CASE("a run that is held for doubles goes on only by an order that names them all") {
  Orders orders;
  orders.note_double("pick");
  CHECK(orders.has_new_double());
  orders.adopt(record("pause"), order(1, true, {"pick"}));
  CHECK_FALSE(orders.has_new_double());
  CHECK(orders.is_held_for_doubles());
  CHECK_FALSE(orders.is_newer(order(2, false)));
  orders.outbid(order(7, false));
  CHECK(orders.is_outbid());
  CHECK(orders.next_hold(1) == 8);
  CHECK(orders.next_hold(9) == 10);
  CHECK(orders.is_newer(order(8, false, {"pick"})));
  orders.adopt(record("pause"), order(8, false, {"pick"}));
  CHECK(orders.doubles().empty());
  orders.note_double("pick");  // somebody has looked
  CHECK(orders.doubles().empty());
}

TEST_CASE("what a run is held for as done twice counts as that also where only the order is known") {
  Orders orders;
  orders.note_double("pick");
  orders.adopt(record("pause"), order(1, true, {"pick", "put"}));
  CHECK(orders.doubles() == std::vector<std::string>{"pick", "put"});
  CHECK(orders.is_double("put"));
  CHECK_FALSE(orders.has_new_double());
  orders.adopt(record("pause"), order(2, false, {"pick", "put"}));
  CHECK(orders.doubles().empty());
  CHECK_FALSE(orders.is_double("put"));
}

TEST_CASE("the judge's holds are numbered up to a bound, so that one more order can let the run go on") {
  const Orders orders;
  CHECK(orders.next_hold(kMaxPauses - 1) == kMaxPauses);
  CHECK(orders.next_hold(kMaxPauses) == kMaxPauses);
}

TEST_CASE("an abort and an end close the run, and the orders that count travel together") {
  Orders orders;
  CHECK(orders.records().empty());
  orders.adopt(record("pause"), order(1, true));
  orders.abort(record("abort"));
  CHECK(orders.is_aborted());
  CHECK_FALSE(orders.is_open());
  REQUIRE(orders.records().size() == 2);
  CHECK(orders.records()[0].kind == "pause");
  CHECK(orders.records()[1].kind == "abort");
  Orders ended;
  ended.end(record("end"));
  CHECK(ended.has_ended());
  CHECK_FALSE(ended.is_open());
  CHECK(ended.records().empty());
}
