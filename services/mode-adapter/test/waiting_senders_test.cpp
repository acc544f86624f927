#include "services/mode-adapter/core/waiting_senders.hpp"

#include <doctest/doctest.h>

#include "common/drivers/lines/driver.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

Now at(double s) {
  return {MonotonicTime{} + seconds(s), UtcTime{}};
}

Inbound request(const std::string& subtype, const std::string& source, std::uint32_t remaining_ms = 1000) {
  return {MessageType::request, source, "r1", 7, 0, 0, remaining_ms, Opaque{subtype, "data"}};
}

struct Waiting {
  LinesDriver driver{{}, "r1"};
  WaitingSenders senders;
  void add(Token token, const Inbound& message, double s) { senders.add(token, message, driver, at(s)); }
};

}  // namespace

TEST_CASE("the oldest request for a subtype from a sender is answered first, and each once") {
  Waiting is;
  is.add(1, request("position", "a"), 0);
  is.add(2, request("position", "b"), 0);
  is.add(3, request("position", "a"), 0);
  CHECK_FALSE(is.senders.take_answered("battery", "a"));
  const auto answered = is.senders.take_answered("position", "a");
  REQUIRE(answered);
  CHECK(get<Opaque>(answered->body).data.empty());
  CHECK_FALSE(is.senders.take(1));
  CHECK(is.senders.take(3));
  CHECK(is.senders.take_answered("position", "b"));
  CHECK(is.senders.size() == 0);
  CHECK_FALSE(is.senders.next_deadline());
}

TEST_CASE("a request waits for as long as its sender does, ten seconds at most") {
  Waiting is;
  is.add(1, request("position", "a", 500), 0);
  is.add(2, request("position", "b", 60'000), 0);
  CHECK(is.senders.next_deadline() == at(0.5).mono);
  CHECK_FALSE(is.senders.take_expired(at(0.4)));
  const auto expired = is.senders.take_expired(at(0.5));
  REQUIRE(expired);
  CHECK(expired->first == 1);
  CHECK_FALSE(is.senders.take_expired(at(9.9)));
  CHECK(is.senders.take_expired(at(10)));
}

TEST_CASE("the requests of a driver whose robot has left are taken one by one") {
  Waiting is;
  const LinesDriver other({}, "r1");
  is.add(1, request("position", "a"), 0);
  is.add(2, request("battery", "a"), 0);
  CHECK_FALSE(is.senders.take_any_of(&other));
  CHECK(is.senders.take_any_of(&is.driver));
  CHECK(is.senders.take_any_of(&is.driver));
  CHECK_FALSE(is.senders.take_any_of(&is.driver));
}

TEST_CASE(
    "who has the most requests gives way to who asks, by its newest; who would have as many itself does not get in") {
  Waiting is;
  for (Token token = 1; token <= 5; ++token) is.add(token, request("position", "a"), 0);
  const auto taken = is.senders.take_for("b");
  REQUIRE(taken);
  CHECK(taken->first == 5);
  CHECK(taken->second.message.source == "a");
  CHECK(is.senders.size() == 4);
  CHECK_FALSE(is.senders.take_for("a"));
  for (Token token = 6; token <= 8; ++token) is.add(token, request("position", "b"), 0);
  CHECK_FALSE(is.senders.take_for("b"));
}
