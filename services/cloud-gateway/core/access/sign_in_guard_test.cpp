// Guessing from one address, from many, from the user's own; the user can still sign in.
#include "services/cloud-gateway/core/access/sign_in_guard.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;
using namespace std::chrono_literals;

namespace {

struct GuardedDoor {
  MonotonicTime now{Duration(1h).count()};
  SignInGuard guard;

  bool may(std::string_view user, std::string_view source) { return guard.wait(user, source, now) == 0s; }
  bool fails(const std::string& user, const std::string& source) {
    if (!may(user, source)) return false;
    guard.begin(user, source, now);
    return true;
  }
  bool succeeds(const std::string& user, const std::string& source) {
    if (!may(user, source)) return false;
    guard.succeeded(guard.begin(user, source, now));
    return true;
  }
};

}  // namespace

TEST_CASE("given five failures from one address, then that name waits there and everywhere, and others do not") {
  GuardedDoor door;
  int tries = 0;
  while (door.fails("ann", "evil")) ++tries;
  CHECK(tries == 6);  // the sixth begins the wait
  CHECK_FALSE(door.may("ann", "elsewhere"));
  CHECK(door.may("bob", "evil"));
  door.now = door.now + 1s;
  CHECK(door.may("ann", "elsewhere"));
}

TEST_CASE("given many names from one address, then the address waits, and other addresses do not") {
  GuardedDoor door;
  int tries = 0;
  while (door.fails("u" + std::to_string(tries), "evil")) ++tries;
  CHECK(tries == 21);
  CHECK_FALSE(door.may("ann", "evil"));
  CHECK(door.may("ann", "desk"));
}

TEST_CASE(
    "given a thousand addresses that guess a name for a day, then the user still comes in from his desk at once") {
  GuardedDoor door;
  REQUIRE(door.succeeds("ann", "desk"));
  int tries = 0;
  for (int second = 0; second < 24 * 3600; second += 10) {
    tries += door.fails("ann", "evil" + std::to_string(second % 1000)) ? 1 : 0;
    door.now = door.now + 10s;
    if (second % 3600 == 0) CHECK(door.succeeds("ann", "desk"));
  }
  CHECK(tries < 120);  // tries in a day of guessing
  CHECK_FALSE(door.may("ann", "new phone"));
}

TEST_CASE("given somebody guesses from the user's own address, then the user waits for a minute at most") {
  GuardedDoor door;
  REQUIRE(door.succeeds("ann", "hall"));
  for (int i = 0; i < 1000; ++i) {
    door.fails("ann", "hall");
    door.now = door.now + 1s;
  }
  CHECK(door.guard.wait("ann", "hall", door.now) <= 1min);
  door.now = door.now + 1min;
  CHECK(door.succeeds("ann", "hall"));
}

TEST_CASE("tries during a wait are not counted: nobody makes it longer") {
  GuardedDoor door;
  while (door.fails("ann", "evil")) {
  }
  const Duration before = door.guard.wait("ann", "evil", door.now);
  for (int i = 0; i < 100; ++i) CHECK_FALSE(door.fails("ann", "evil"));
  CHECK(door.guard.wait("ann", "evil", door.now) == before);
}

TEST_CASE("given an attacker signs in as himself between guesses, then his address is not cleared by it") {
  GuardedDoor door;
  int tries = 0;
  for (int i = 0; i < 100; ++i) {
    tries += door.fails("u" + std::to_string(i), "evil") ? 1 : 0;
    door.succeeds("mallory", "evil");
  }
  CHECK(tries == 21);
}

TEST_CASE("given many tries at once, then each counts before any has ended") {
  GuardedDoor door;
  std::vector<Attempt> attempts;
  while (door.may("ann", "evil")) attempts.push_back(door.guard.begin("ann", "evil", door.now));
  CHECK(attempts.size() == 6);
  for (const Attempt& attempt : attempts) door.guard.cancel(attempt);  // no password was checked
  CHECK(door.may("ann", "evil"));
  CHECK(door.guard.rows() == 0);
}

TEST_CASE("a pair that becomes known while it tries gives back what it took as a stranger") {
  GuardedDoor door;
  const Attempt first = door.guard.begin("ann", "desk", door.now);
  const Attempt second = door.guard.begin("ann", "desk", door.now);
  door.guard.succeeded(first);
  door.guard.succeeded(second);
  CHECK(door.guard.rows() == 0);
}

TEST_CASE("known are the last eight addresses of a user, through a restart, until he is removed") {
  GuardedDoor door;
  for (int i = 0; i < 9; ++i) REQUIRE(door.succeeds("ann", "a" + std::to_string(i)));
  CHECK_FALSE(door.guard.is_known("ann", "a0"));
  CHECK(door.guard.is_known("ann", "a1"));
  CHECK_FALSE(door.guard.is_known("bob", "a1"));
  SignInGuard after;
  for (const auto& [user, sources] : door.guard.known())
    for (auto at = sources.rbegin(); at != sources.rend(); ++at) after.restore_known(user, *at);
  CHECK(after.known() == door.guard.known());
  after.forget_user("ann");
  CHECK_FALSE(after.is_known("ann", "a1"));
}

TEST_CASE("given ten thousand names and addresses, then memory is bounded and the guessed name still waits") {
  GuardedDoor door;
  for (int i = 0; i < 9; ++i) door.guard.begin("ann", "e" + std::to_string(i), door.now);
  for (int i = 0; i < 10'000; ++i)
    door.guard.begin("u" + std::to_string(i % 6'000), "s" + std::to_string(i), door.now + std::chrono::nanoseconds(i));
  CHECK(door.guard.rows() <= kUserFailures.room + kSourceFailures.room);
  CHECK_FALSE(door.may("ann", "desk"));
}
