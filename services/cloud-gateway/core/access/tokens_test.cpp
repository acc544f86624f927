// A machine's token from creation to its end.
#include "services/cloud-gateway/core/access/tokens.hpp"

#include "services/cloud-gateway/core/access/test/gateway_parts.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr Duration kDay = std::chrono::hours(24);

TokenWish wish(const std::string& name, Duration life = kDay) {
  return {name, UserRole::operator_, true, life, "ann"};
}

}  // namespace

TEST_CASE("given a token is made, then its secret opens until its end, and is kept nowhere") {
  Parts hall;
  const auto secret = hall.tokens.make(wish("exporter"), hall.now.utc);
  REQUIRE(secret);
  CHECK(secret->starts_with("trb_"));
  const auto changes = hall.tokens.take_changes();
  REQUIRE(changes.size() == 1);
  CHECK(changes[0].row->key.size() == 32);
  CHECK(changes[0].row->made_by == "ann");
  const Token* token = hall.tokens.find(*secret, hall.now.utc);
  REQUIRE(token != nullptr);
  CHECK(token->read_only);
  hall.pass(kDay - std::chrono::nanoseconds(1));
  CHECK(hall.tokens.find(*secret, hall.now.utc) != nullptr);
  hall.pass(std::chrono::nanoseconds(1));
  CHECK(hall.tokens.find(*secret, hall.now.utc) == nullptr);
  CHECK(hall.tokens.all().contains("exporter"));  // still listed
}

TEST_CASE("an end is mandatory, and within a year") {
  Parts hall;
  CHECK(hall.tokens.make(wish("a", Duration{0}), hall.now.utc).error().code == Errc::bad_value);
  CHECK(hall.tokens.make(wish("a", -kDay), hall.now.utc).error().code == Errc::bad_value);
  CHECK(hall.tokens.make(wish("a", kTokenLife + kDay), hall.now.utc).error().code == Errc::bad_value);
  CHECK(hall.tokens.make(wish("Not:a name"), hall.now.utc).error().code == Errc::bad_value);
  CHECK(hall.tokens.make(wish("a", kTokenLife), hall.now.utc));
  CHECK(hall.tokens.make(wish("a"), hall.now.utc).error().code == Errc::duplicate);
}

TEST_CASE("given it is revoked, then its secret opens nothing, and its name is free for another secret") {
  Parts hall;
  const std::string first = *hall.tokens.make(wish("a"), hall.now.utc);
  REQUIRE(hall.tokens.revoke("a"));
  CHECK(hall.tokens.revoke("a").error().code == Errc::missing);
  CHECK(hall.tokens.find(first, hall.now.utc) == nullptr);
  const std::string second = *hall.tokens.make(wish("a"), hall.now.utc);
  CHECK(hall.tokens.find(first, hall.now.utc) == nullptr);
  CHECK(hall.tokens.find(second, hall.now.utc) != nullptr);
  CHECK(hall.tokens.take_changes().size() == 3);
}

TEST_CASE("what is no token opens nothing, a session's id neither") {
  Parts hall;
  hall.add("ann");
  const std::string secret = *hall.tokens.make(wish("a"), hall.now.utc);
  const std::string session = hall.sign_in("ann");
  for (const std::string& wrong : {std::string(), std::string("trb_"), secret.substr(4), secret + "0", session,
                                   "trb_" + session.substr(0, 63) + "x", std::string(100'000, 'a')})
    CHECK(hall.tokens.find(wrong, hall.now.utc) == nullptr);
}

TEST_CASE("given all places are taken, then ended ones make room, and valid ones do not") {
  Parts hall;
  for (std::size_t i = 0; i < kMaxTokens; ++i)
    REQUIRE(hall.tokens.make(wish("t" + std::to_string(i), i == 3 ? kDay : 9 * kDay), hall.now.utc));
  CHECK(hall.tokens.make(wish("late"), hall.now.utc).error().code == Errc::queue_full);
  hall.pass(kDay);
  CHECK(hall.tokens.make(wish("late"), hall.now.utc));
  CHECK_FALSE(hall.tokens.all().contains("t3"));
}

TEST_CASE("given a restart, then tokens are as they were stored, and one stored anew replaces the old secret") {
  Parts hall;
  const std::string old_secret = *hall.tokens.make(wish("a"), hall.now.utc);
  Tokens after{hall.random};
  after.restore(*hall.tokens.take_changes()[0].row);
  CHECK(after.find(old_secret, hall.now.utc) != nullptr);
  REQUIRE(hall.tokens.revoke("a"));
  const std::string new_secret = *hall.tokens.make(wish("a"), hall.now.utc);
  after.restore(*hall.tokens.take_changes().back().row);
  CHECK(after.find(old_secret, hall.now.utc) == nullptr);
  CHECK(after.find(new_secret, hall.now.utc) != nullptr);
  CHECK(after.take_changes().empty());
}
