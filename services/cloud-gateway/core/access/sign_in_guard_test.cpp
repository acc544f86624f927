// Guessing from one address, from many, from the user's own; the user can still sign in.
#include "services/cloud-gateway/core/access/sign_in_guard.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;
using namespace std::chrono_literals;

namespace {

struct GuardedSignIn {
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
  GuardedSignIn sign_in;
  int tries = 0;
  while (sign_in.fails("ann", "evil")) ++tries;
  CHECK(tries == 6);  // the sixth begins the wait
  CHECK_FALSE(sign_in.may("ann", "elsewhere"));
  CHECK(sign_in.may("bob", "evil"));
  sign_in.now = sign_in.now + 1s;
  CHECK(sign_in.may("ann", "elsewhere"));
}

TEST_CASE("given many names from one address, then the address waits, and other addresses do not") {
  GuardedSignIn sign_in;
  int tries = 0;
  while (sign_in.fails("u" + std::to_string(tries), "evil")) ++tries;
  CHECK(tries == 21);
  CHECK_FALSE(sign_in.may("ann", "evil"));
  CHECK(sign_in.may("ann", "desk"));
}

TEST_CASE(
    "given a thousand addresses that guess a name for a day, then the user still comes in from his desk at once") {
  GuardedSignIn sign_in;
  REQUIRE(sign_in.succeeds("ann", "desk"));
  int tries = 0;
  for (int second = 0; second < 24 * 3600; second += 10) {
    tries += sign_in.fails("ann", "evil" + std::to_string(second % 1000)) ? 1 : 0;
    sign_in.now = sign_in.now + 10s;
    if (second % 3600 == 0) CHECK(sign_in.succeeds("ann", "desk"));
  }
  CHECK(tries < 120);  // tries in a day of guessing
  CHECK_FALSE(sign_in.may("ann", "new phone"));
}

TEST_CASE("given somebody guesses from the user's own address, then the user waits for a minute at most") {
  GuardedSignIn sign_in;
  REQUIRE(sign_in.succeeds("ann", "hall"));
  for (int i = 0; i < 1000; ++i) {
    sign_in.fails("ann", "hall");
    sign_in.now = sign_in.now + 1s;
  }
  CHECK(sign_in.guard.wait("ann", "hall", sign_in.now) <= 1min);
  sign_in.now = sign_in.now + 1min;
  CHECK(sign_in.succeeds("ann", "hall"));
}

TEST_CASE("tries during a wait are not counted: nobody makes it longer") {
  GuardedSignIn sign_in;
  while (sign_in.fails("ann", "evil")) {
  }
  const Duration before = sign_in.guard.wait("ann", "evil", sign_in.now);
  for (int i = 0; i < 100; ++i) CHECK_FALSE(sign_in.fails("ann", "evil"));
  CHECK(sign_in.guard.wait("ann", "evil", sign_in.now) == before);
}

TEST_CASE("given an attacker signs in as himself between guesses, then his address is not cleared by it") {
  GuardedSignIn sign_in;
  int tries = 0;
  for (int i = 0; i < 100; ++i) {
    tries += sign_in.fails("u" + std::to_string(i), "evil") ? 1 : 0;
    sign_in.succeeds("mallory", "evil");
  }
  CHECK(tries == 21);
}

TEST_CASE("given many tries at once, then each counts before any has ended") {
  GuardedSignIn sign_in;
  std::vector<Attempt> attempts;
  while (sign_in.may("ann", "evil")) attempts.push_back(sign_in.guard.begin("ann", "evil", sign_in.now));
  CHECK(attempts.size() == 6);
  for (const Attempt& attempt : attempts) sign_in.guard.cancel(attempt);  // no password was checked
  CHECK(sign_in.may("ann", "evil"));
  CHECK(sign_in.guard.rows() == 0);
}

TEST_CASE("a pair that becomes known while it tries gives back what it took as a stranger") {
  GuardedSignIn sign_in;
  const Attempt first = sign_in.guard.begin("ann", "desk", sign_in.now);
  const Attempt second = sign_in.guard.begin("ann", "desk", sign_in.now);
  sign_in.guard.succeeded(first);
  sign_in.guard.succeeded(second);
  CHECK(sign_in.guard.rows() == 0);
}

TEST_CASE("known are the last eight addresses of a user, through a restart, until he is removed") {
  GuardedSignIn sign_in;
  for (int i = 0; i < 9; ++i) REQUIRE(sign_in.succeeds("ann", "a" + std::to_string(i)));
  CHECK_FALSE(sign_in.guard.is_known("ann", "a0"));
  CHECK(sign_in.guard.is_known("ann", "a1"));
  CHECK_FALSE(sign_in.guard.is_known("bob", "a1"));
  SignInGuard after;
  for (const auto& [user, sources] : sign_in.guard.known())
    for (auto at = sources.rbegin(); at != sources.rend(); ++at) after.restore_known(user, *at);
  CHECK(after.known() == sign_in.guard.known());
  after.forget_user("ann");
  CHECK_FALSE(after.is_known("ann", "a1"));
}

TEST_CASE("given ten thousand names and addresses, then memory is bounded and the guessed name still waits") {
  GuardedSignIn sign_in;
  for (int i = 0; i < 9; ++i) sign_in.guard.begin("ann", "e" + std::to_string(i), sign_in.now);
  for (int i = 0; i < 10'000; ++i)
    sign_in.guard.begin("u" + std::to_string(i % 6'000), "s" + std::to_string(i),
                        sign_in.now + std::chrono::nanoseconds(i));
  CHECK(sign_in.guard.rows() <= kUserFailures.room + kSourceFailures.room);
  CHECK_FALSE(sign_in.may("ann", "desk"));
}
