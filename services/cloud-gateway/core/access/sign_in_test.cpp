// A sign-in: the request, the check on a pool, the answer, and what can happen in between.
#include "services/cloud-gateway/core/access/sign_in.hpp"

#include "services/cloud-gateway/core/access/test/gateway_parts.hpp"

using namespace trb;
using namespace trb::gateway;
using namespace std::chrono_literals;

namespace {

struct Gate : Parts {
  SignInGuard guard;
  SignIn sign_in_machine{users, sessions, guard, "dummy"};
  SignInEffects out;
  SignInId last = 0;

  Gate() {
    add("root", UserRole::admin);
    add("ann");
  }
  SignInId ask(const std::string& user, const std::string& source = "desk", const std::string& old_session = {}) {
    out = {};
    sign_in_machine.request({++last, user, "password of " + user, source, old_session}, now, out);
    return last;
  }
  void end(SignInId id, CheckResult result) {
    out = {};
    sign_in_machine.checked(id, result, now, out);
  }
  SignInAnswer only_answer() {
    REQUIRE(out.answers.size() == 1);
    return out.answers.front();
  }
  /// Two checks run, for other users.
  void fill_pool() {
    ask("x1", "there1");
    ask("x2", "there2");
  }
};

}  // namespace

TEST_CASE("given the right password, then one check with the user's hash, and a session that is new") {
  Gate gate;
  const SignInId id = gate.ask("ann");
  REQUIRE(gate.out.checks.size() == 1);
  CHECK(gate.out.checks[0].id == id);
  CHECK(gate.out.checks[0].hash == "hash of ann");
  CHECK(gate.out.checks[0].password == "password of ann");
  CHECK(gate.out.answers.empty());
  gate.end(id, CheckResult::right);
  const SignInAnswer answer = gate.only_answer();
  CHECK(answer.outcome == SignInOutcome::signed_in);
  CHECK(gate.is_open(answer.session->id));
  CHECK(gate.guard.is_known("ann", "desk"));
  CHECK_FALSE(gate.sign_in_machine.next_deadline());
}

TEST_CASE("given a wrong password, no such user, a disabled one, or a name that is none: one check, the same answer") {
  for (const char* name : {"ann", "nobody", "off", "No Name\n"}) {
    Gate gate;
    gate.add("off");
    REQUIRE(gate.users.set_disabled("off", true));
    const SignInId id = gate.ask(name);
    REQUIRE(gate.out.checks.size() == 1);
    CHECK(gate.out.checks[0].hash == (std::string(name) == "ann" ? "hash of ann" : "dummy"));
    gate.end(id, CheckResult::wrong);
    CHECK(gate.only_answer().outcome == SignInOutcome::refused);
    CHECK(gate.only_answer().retry_after_s == 0);
    CHECK(gate.sessions.size() == 0);
  }
}

TEST_CASE("given somebody knows what the dummy hash is of, then he is nobody still") {
  Gate gate;
  gate.end(gate.ask("nobody"), CheckResult::right);
  CHECK(gate.only_answer().outcome == SignInOutcome::refused);
}

TEST_CASE("given a user comes while a check against the dummy hash runs, then its result is not about him") {
  Gate gate;
  const SignInId id = gate.ask("late");
  gate.users.restore({"late", UserRole::admin, "hash", false, gate.now.utc, {}});
  gate.end(id, CheckResult::right);
  CHECK(gate.only_answer().outcome == SignInOutcome::refused);
}

TEST_CASE("given the browser has a session already, also one that somebody planted, then a sign-in ends it") {
  Gate gate;
  const std::string planted = gate.sign_in("root");
  const SignInId wrong = gate.ask("ann", "desk", planted);
  gate.end(wrong, CheckResult::wrong);
  CHECK(gate.is_open(planted));  // a failed sign-in ends no session
  gate.end(gate.ask("ann", "desk", planted), CheckResult::right);
  CHECK(gate.only_answer().session->id != planted);
  CHECK_FALSE(gate.is_open(planted));
}

TEST_CASE("given the user is changed while his password is checked, then the old one opens nothing") {
  const std::array<Status (*)(Users&), 3> changes{[](Users& users) { return users.set_password("ann", "another"); },
                                                  [](Users& users) { return users.set_disabled("ann", true); },
                                                  [](Users& users) { return users.remove("ann"); }};
  for (const auto& change : changes) {
    Gate gate;
    const SignInId id = gate.ask("ann");
    REQUIRE(change(gate.users));
    gate.end(id, CheckResult::right);
    CHECK(gate.only_answer().outcome == SignInOutcome::refused);
    CHECK(gate.sessions.size() == 0);
  }
}

TEST_CASE("given the password is changed while the request is queued, then the new hash is checked") {
  Gate gate;
  gate.fill_pool();
  gate.ask("ann");
  CHECK(gate.out.checks.empty());
  REQUIRE(gate.users.set_password("ann", "another"));
  gate.end(1, CheckResult::wrong);
  REQUIRE(gate.out.checks.size() == 1);
  CHECK(gate.out.checks[0].hash == "another");
}

TEST_CASE("two checks at once, then a queue in order, and the first too many is answered busy and when to come again") {
  Gate gate;
  std::size_t checks = 0;
  std::size_t accepted = 0;
  for (;; ++accepted) {
    gate.ask("u" + std::to_string(accepted), "a" + std::to_string(accepted));
    if (!gate.out.answers.empty()) break;
    checks += gate.out.checks.size();
  }
  CHECK(checks == 2);
  CHECK(accepted == kChecksAtOnce + kQueuedChecks - kPlacesForKnown);
  CHECK(gate.only_answer().outcome == SignInOutcome::busy);
  CHECK(gate.only_answer().retry_after_s == kBusyRetry_s);
  for (SignInId id = 1; id <= accepted; ++id) {
    gate.end(id, CheckResult::wrong);
    CHECK(gate.out.checks.size() == (id + 2 <= accepted ? 1 : 0));
    if (!gate.out.checks.empty()) CHECK(gate.out.checks[0].id == id + 2);
  }
}

TEST_CASE("given strangers fill the queue, then the user at his desk has a place; one address never fills it") {
  Gate gate;
  gate.end(gate.ask("ann", "desk"), CheckResult::right);
  int taken = 0;
  for (; taken < 100; ++taken) {
    gate.ask("u" + std::to_string(taken), "evil");
    if (!gate.out.answers.empty()) break;
  }
  CHECK(taken == static_cast<int>(kChecksOfSource));
  for (int i = 0; i < 100; ++i) gate.ask("v" + std::to_string(i), "evil" + std::to_string(i));
  CHECK(gate.only_answer().outcome == SignInOutcome::busy);
  gate.ask("root", "desk");  // the pair is known, not the address
  CHECK(gate.only_answer().outcome == SignInOutcome::busy);
  gate.ask("ann", "desk");
  CHECK(gate.out.answers.empty());
}

TEST_CASE("given too many failures, then it is refused with its wait and costs no check") {
  Gate gate;
  for (int i = 0; i < 6; ++i) gate.end(gate.ask("ann"), CheckResult::wrong);
  gate.ask("ann");
  CHECK(gate.out.checks.empty());
  CHECK(gate.only_answer().outcome == SignInOutcome::wait);
  CHECK(gate.only_answer().retry_after_s == 1);
  for (int i = 0; i < 6; ++i) gate.end(gate.ask("nobody", "cellar"), CheckResult::wrong);
  gate.ask("nobody", "cellar");
  CHECK(gate.only_answer().outcome == SignInOutcome::wait);  // an unknown user waits like a known one
  CHECK(gate.only_answer().retry_after_s == 1);
}

TEST_CASE("given a result that comes twice, unasked, or of a queued request, then it does nothing") {
  Gate gate;
  const SignInId id = gate.ask("ann");
  gate.end(id, CheckResult::right);
  gate.end(id, CheckResult::right);
  CHECK(gate.out.answers.empty());
  gate.end(77, CheckResult::right);
  CHECK(gate.out.answers.empty());
  CHECK(gate.sessions.size() == 1);
  gate.fill_pool();
  const SignInId queued = gate.ask("ann");
  gate.end(queued, CheckResult::right);
  CHECK(gate.out.answers.empty());
  CHECK(gate.out.checks.empty());
}

TEST_CASE("given a request's id that is under way, then it is not taken twice") {
  Gate gate;
  gate.ask("ann");
  gate.out = {};
  gate.sign_in_machine.request({gate.last, "root", "x", "desk", ""}, gate.now, gate.out);
  CHECK(gate.out.checks.empty());
  CHECK(gate.out.answers.empty());
}

TEST_CASE(
    "given a check that takes over 10 s, then it is answered, keeps its place, and makes no session when it ends") {
  Gate gate;
  const SignInId slow = gate.ask("ann");
  gate.ask("x", "there");
  const SignInId queued = gate.ask("root");
  CHECK(*gate.sign_in_machine.next_deadline() == gate.now.mono + kSignInTime);
  gate.pass(kSignInTime);
  gate.out = {};
  gate.sign_in_machine.tick(gate.now, gate.out);
  REQUIRE(gate.out.answers.size() == 3);
  for (const SignInAnswer& answer : gate.out.answers) CHECK(answer.outcome == SignInOutcome::unavailable);
  CHECK_FALSE(gate.sign_in_machine.next_deadline());
  gate.out = {};
  gate.sign_in_machine.tick(gate.now, gate.out);
  CHECK(gate.out.answers.empty());
  gate.ask("ann");
  CHECK(gate.out.checks.empty());  // both still run
  gate.end(slow, CheckResult::right);
  CHECK(gate.out.answers.empty());
  CHECK(gate.out.checks.size() == 1);
  CHECK(gate.sessions.size() == 0);
  gate.end(queued, CheckResult::right);
  CHECK(gate.out.answers.empty());
}

TEST_CASE("given the asker leaves, then what is queued is dropped uncounted, and what runs makes no session") {
  Gate gate;
  gate.fill_pool();
  const SignInId queued = gate.ask("ann");
  const std::size_t before = gate.guard.rows();
  gate.sign_in_machine.left(queued, gate.now, gate.out);
  CHECK(gate.guard.rows() == before - 2);
  gate.end(1, CheckResult::wrong);
  CHECK(gate.out.checks.empty());
  const SignInId running = gate.ask("ann");
  gate.out = {};
  gate.sign_in_machine.left(running, gate.now, gate.out);
  gate.sign_in_machine.left(running, gate.now, gate.out);
  gate.sign_in_machine.left(99, gate.now, gate.out);
  gate.end(running, CheckResult::right);
  CHECK(gate.out.answers.empty());
  CHECK(gate.sessions.size() == 0);
}

TEST_CASE("who leaves before his guess is answered has guessed all the same") {
  Gate gate;
  for (int i = 0; i < 6; ++i) {
    const SignInId id = gate.ask("ann", "evil");
    gate.sign_in_machine.left(id, gate.now, gate.out);
    gate.end(id, CheckResult::wrong);
  }
  gate.ask("ann", "evil");
  CHECK(gate.only_answer().outcome == SignInOutcome::wait);
}

TEST_CASE("given a check that failed by itself, then nobody is blamed") {
  Gate gate;
  gate.end(gate.ask("ann"), CheckResult::failed);
  CHECK(gate.only_answer().outcome == SignInOutcome::unavailable);
  CHECK(gate.guard.rows() == 0);
}

TEST_CASE("given a password over its bound, then it is refused without a check") {
  Gate gate;
  gate.sign_in_machine.request({1, "ann", std::string(257, 'x'), "desk", ""}, gate.now, gate.out);
  CHECK(gate.out.checks.empty());
  CHECK(gate.only_answer().outcome == SignInOutcome::refused);
}
