// Repeated requests: during the first, afterwards, after kill -9.
#include "services/cloud-gateway/core/live/idempotency.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

const RequestKey kAnn{"ann", "key-1"};
const StoredAnswer kAnswer{201, "{\"run\":\"3f\"}"};

UtcTime at(double s) {
  return UtcTime{1'700'000'000'000'000'000} + seconds(s);
}

template <class T>
const T* got(const Result<Idempotency::Begun>& begun) {
  return begun ? std::get_if<T>(&*begun) : nullptr;
}

}  // namespace

TEST_CASE("the first request acts, a repeat meanwhile waits, one afterwards has the same answer") {
  Idempotency keys;
  const auto begun = keys.begin(kAnn, "digest", "run 3f", at(0));
  REQUIRE(got<Idempotency::Act>(begun));
  CHECK(got<Idempotency::Act>(begun)->store.effect == "run 3f");
  CHECK_FALSE(got<Idempotency::Act>(begun)->store.answer);
  CHECK(got<Idempotency::Wait>(keys.begin(kAnn, "digest", "run 4f", at(1))));
  const auto stored = keys.finish(kAnn, kAnswer);
  REQUIRE(stored);
  CHECK(stored->answer == kAnswer);
  CHECK(stored->effect == "run 3f");
  const auto again = keys.begin(kAnn, "digest", "run 5f", at(2));
  REQUIRE(got<StoredAnswer>(again));
  CHECK(*got<StoredAnswer>(again) == kAnswer);
  CHECK_FALSE(keys.finish(kAnn, {500, ""}));
}

TEST_CASE("the same key with another request is refused, running or answered; another user's key is his own") {
  Idempotency keys;
  (void)keys.begin(kAnn, "digest", "", at(0));
  CHECK(keys.begin(kAnn, "other", "", at(0)).error().code == Errc::conflict);
  keys.finish(kAnn, kAnswer);
  CHECK(keys.begin(kAnn, "other", "", at(0)).error().code == Errc::conflict);
  CHECK(got<Idempotency::Act>(keys.begin({"bob", "key-1"}, "other", "", at(0))));
}

TEST_CASE("killed after the answer was stored: the repeat has it") {
  Idempotency before;
  (void)before.begin(kAnn, "digest", "run 3f", at(0));
  const auto stored = before.finish(kAnn, kAnswer);
  Idempotency after;
  after.replace({*stored});
  CHECK(*got<StoredAnswer>(after.begin(kAnn, "digest", "", at(2))) == kAnswer);
  CHECK(after.unsure().empty());
}

TEST_CASE("killed before the intent was stored: the repeat acts") {
  Idempotency after;
  after.replace({});
  CHECK(got<Idempotency::Act>(after.begin(kAnn, "digest", "", at(2))));
}

TEST_CASE("killed between: nobody acts again until somebody knows whether it was done") {
  Idempotency before;
  const auto begun = before.begin(kAnn, "digest", "run 3f", at(0));
  const StoredRequest intent = got<Idempotency::Act>(begun)->store;
  Idempotency after;
  after.replace({intent});
  CHECK(got<Idempotency::Wait>(after.begin(kAnn, "digest", "", at(2))));
  CHECK(after.begin(kAnn, "other", "", at(2)).error().code == Errc::conflict);
  REQUIRE(after.unsure().size() == 1);
  CHECK(after.unsure()[0].effect == "run 3f");
  SUBCASE("it was: it is answered as it would have been") {
    REQUIRE(after.finish(kAnn, kAnswer));
    CHECK(after.unsure().empty());
    CHECK(*got<StoredAnswer>(after.begin(kAnn, "digest", "", at(3))) == kAnswer);
  }
  SUBCASE("it provably was not: the repeat acts") {
    CHECK(after.release(kAnn));
    CHECK(got<Idempotency::Act>(after.begin(kAnn, "digest", "run 4f", at(3))));
  }
}

TEST_CASE("what was answered is never released") {
  Idempotency keys;
  (void)keys.begin(kAnn, "digest", "", at(0));
  keys.finish(kAnn, kAnswer);
  CHECK_FALSE(keys.release(kAnn));
  CHECK_FALSE(keys.release({"ann", "unknown"}));
}

TEST_CASE("a key lives 24 h from its intent; what runs stays") {
  Idempotency keys;
  (void)keys.begin(kAnn, "digest", "", at(0));
  (void)keys.begin({"ann", "runs"}, "digest", "", at(0));
  keys.finish(kAnn, kAnswer);
  CHECK(keys.take_expired(at(86'399)).empty());
  CHECK(keys.take_expired(at(86'400)) == std::vector<RequestKey>{kAnn});
  CHECK(got<Idempotency::Act>(keys.begin(kAnn, "digest", "", at(86'401))));
  CHECK(got<Idempotency::Wait>(keys.begin({"ann", "runs"}, "digest", "", at(86'401))));
}

TEST_CASE("what another gateway has stored takes the place of what was known; what it is at work on is waited for") {
  Idempotency keys;
  (void)keys.begin({"ann", "old"}, "digest", "", at(0));
  StoredRequest theirs{kAnn, "digest", "run-1", at(100), std::nullopt};
  keys.replace({theirs});
  CHECK(keys.find({"ann", "old"}) == nullptr);
  CHECK(got<Idempotency::Wait>(keys.begin(kAnn, "digest", "", at(101))));
  CHECK(keys.unsure(at(100)).empty());
  CHECK(keys.unsure(at(101)) == std::vector{theirs});
  theirs.answer = kAnswer;
  keys.replace({theirs});
  CHECK(got<StoredAnswer>(keys.begin(kAnn, "digest", "", at(102))));
  CHECK(keys.unsure().empty());
}

TEST_CASE("the clock steps by more than a day: a key made since the start lives its 24 h, so no repeat acts") {
  Idempotency keys;
  (void)keys.begin({"ann", "before"}, "digest", "", at(0));
  keys.finish({"ann", "before"}, kAnswer);
  (void)keys.begin(kAnn, "digest", "", at(20));
  keys.finish(kAnn, kAnswer);
  (void)keys.begin({"ann", "runs"}, "digest", "", at(30));
  CHECK(keys.move({at(10), at(600), std::chrono::hours(30)}).size() == 2);
  const double step = 30 * 3600;
  CHECK(keys.take_expired(at(step + 601)) == std::vector<RequestKey>{{"ann", "before"}});
  CHECK(got<StoredAnswer>(keys.begin(kAnn, "digest", "", at(step + 601))));
  CHECK(keys.find({"ann", "runs"})->since == at(step + 30));
  CHECK(keys.take_expired(at(step + 86'419)).empty());
  CHECK(keys.take_expired(at(step + 86'420)) == std::vector<RequestKey>{kAnn});
}

TEST_CASE("bounds: a full user is refused, others are not, and nothing is forgotten for it") {
  Idempotency keys;
  for (std::size_t i = 0; i < Idempotency::kMaxOfUser; ++i) {
    (void)keys.begin({"ann", std::to_string(i)}, "d", "", at(0));
    keys.finish({"ann", std::to_string(i)}, kAnswer);
  }
  CHECK(keys.begin({"ann", "more"}, "d", "", at(1)).error().code == Errc::queue_full);
  CHECK(got<StoredAnswer>(keys.begin({"ann", "0"}, "d", "", at(1))));
  CHECK(got<Idempotency::Act>(keys.begin({"bob", "1"}, "d", "", at(1))));
  for (int user = 0; user < 3; ++user) {
    for (std::size_t i = 0; i < Idempotency::kMaxOfUser; ++i) {
      (void)keys.begin({"user" + std::to_string(user), std::to_string(i)}, "d", "", at(1));
    }
  }
  for (std::size_t i = 0; i < Idempotency::kAlwaysOfUser; ++i)
    CHECK(got<Idempotency::Act>(keys.begin({"carol", std::to_string(i)}, "d", "", at(1))));
  CHECK(keys.begin({"carol", "more"}, "d", "", at(1)).error().text().find("20000 are kept") != std::string::npos);
}

TEST_CASE("a long answer is kept whole, up to a bound of each and of all; a short one always is") {
  Idempotency keys;
  const auto finish = [&](const std::string& key, std::size_t size) {
    (void)keys.begin({"ann", key}, "d", "", at(0));
    return keys.finish({"ann", key}, {200, Bytes(size, 'x')})->answer->body.size();
  };
  CHECK(finish("long", Idempotency::kMaxAnswer) == Idempotency::kMaxAnswer);
  CHECK(finish("longer", Idempotency::kMaxAnswer + 1) == 0);
  for (std::size_t i = 1; i < Idempotency::kMaxLong / Idempotency::kMaxAnswer; ++i)
    CHECK(finish(std::to_string(i), Idempotency::kMaxAnswer) == Idempotency::kMaxAnswer);
  CHECK(finish("no-room", Idempotency::kShortAnswer + 1) == 0);
  CHECK(finish("short", Idempotency::kShortAnswer) == Idempotency::kShortAnswer);
  SUBCASE("what is read anew counts once") {
    StoredRequest one = *keys.find({"ann", "long"});
    keys.replace({one, one});
    for (std::size_t i = 1; i < Idempotency::kMaxLong / Idempotency::kMaxAnswer; ++i)
      CHECK(finish(std::to_string(i), Idempotency::kMaxAnswer) == Idempotency::kMaxAnswer);
    CHECK(finish("no-room", Idempotency::kShortAnswer + 1) == 0);
  }
  SUBCASE("what expires makes room") {
    keys.take_expired(at(86'400));
    CHECK(finish("room", Idempotency::kMaxAnswer) == Idempotency::kMaxAnswer);
  }
}

TEST_CASE("keys that are none are refused, an answer that is too long is kept without its body") {
  Idempotency keys;
  for (const std::string& key : {std::string(), std::string(256, 'x'), std::string("a b"), std::string("a\n")}) {
    CHECK(keys.begin({"ann", key}, "d", "", at(0)).error().code == Errc::bad_value);
  }
  CHECK(keys.begin(kAnn, "d", std::string(2000, 'x'), at(0)).error().code == Errc::too_large);
  (void)keys.begin(kAnn, "d", "", at(0));
  CHECK(keys.finish(kAnn, {200, std::string(70'000, 'x')})->answer == StoredAnswer{200, ""});
}

TEST_CASE("what a router refuses before it delivers was not done; a time-out and a lost robot say nothing of it") {
  for (const Errc code : {Errc::queue_full, Errc::peer_unreachable, Errc::peer_expired, Errc::no_service})
    CHECK(Idempotency::means_not_done(code));
  for (const Errc code : {Errc::timeout, Errc::not_confirmed, Errc::robot_offline, Errc::bad_value, Errc::conflict})
    CHECK_FALSE(Idempotency::means_not_done(code));
}
