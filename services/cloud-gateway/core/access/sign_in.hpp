// A sign-in from its request to a session or a refusal.
#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "services/cloud-gateway/core/access/sessions.hpp"
#include "services/cloud-gateway/core/access/sign_in_guard.hpp"

namespace trb::gateway {

using SignInId = std::uint64_t;  ///< of a request, chosen by the shell; never used twice

struct SignInRequest {
  SignInId id = 0;
  std::string user;
  std::string password;
  std::string source;       ///< address of the asker; IPv6 by its /64
  std::string old_session;  ///< what the browser still has: it ends when the new one begins
};

enum class SignInOutcome : std::uint8_t {
  signed_in,
  refused,      ///< no such user, wrong password, disabled: nobody is told which
  wait,         ///< too many failures
  busy,         ///< too many at once
  unavailable,  ///< the check failed or took too long
};
constexpr auto enum_names(SignInOutcome) {
  return std::array<std::string_view, 5>{"signed_in", "refused", "wait", "busy", "unavailable"};
}

struct SignInAnswer {
  SignInId id = 0;
  SignInOutcome outcome{};
  std::int64_t retry_after_s = 0;     ///< of wait, busy and unavailable
  std::optional<NewSession> session;  ///< of signed_in
};

/// Does the password fit the hash? To be answered by SignIn::checked() with the same id.
struct PasswordCheck {
  SignInId id = 0;
  std::string hash;
  std::string password;
};
enum class CheckResult : std::uint8_t { right, wrong, failed };

/// What the shell has to do.
struct SignInEffects {
  std::vector<PasswordCheck> checks;
  std::vector<SignInAnswer> answers;
};

/// A check takes 70 ms of a core and 64 MB: two at once leave the loop its own.
constexpr std::size_t kChecksAtOnce = 2;
/// So the last in the queue waits for half a second.
constexpr std::size_t kQueuedChecks = 16;
/// Places of the queue that only a known pair of name and address gets.
constexpr std::size_t kPlacesForKnown = 4;
/// Of one address, running and queued, unknown pairs; and of one known pair.
constexpr std::size_t kChecksOfSource = 4;
constexpr Duration kSignInTime = std::chrono::seconds(10);
constexpr std::int64_t kBusyRetry_s = 2;

/// -       | request, its name or address has to wait    | answered `wait`
/// -       | request, no place is left                   | answered `busy`
/// -       | request                                     | queued; running if fewer than two do
/// queued  | a place is free                             | running, with the hash as it is now
/// queued  | 10 s, or the asker leaves                   | -, `unavailable`; the try does not count
/// running | right, and the user is as at its start      | -, `signed_in`; with a new session
/// running | wrong; or right, and he was changed         | -, `refused`
/// running | failed                                      | -, `unavailable`; the try does not count
/// running | 10 s, or the asker leaves                   | late: keeps its place, for the check still runs
/// late    | any result                                  | -, no session
/// -       | a result, or a repeated one                 | nothing
/// An unknown or disabled user costs the same check, against a hash that nobody's password fits, and the answer is the
/// same. `now.utc` is steady.
class SignIn {
 public:
  /// `dummy_hash` is made with the parameters of all others.
  SignIn(const Users& users, Sessions& sessions, SignInGuard& guard, std::string dummy_hash)
      : users_(users), sessions_(sessions), guard_(guard), dummy_hash_(std::move(dummy_hash)) {}

  void request(SignInRequest request, Now now, SignInEffects& out);
  void checked(SignInId id, CheckResult result, Now now, SignInEffects& out);
  /// The asker has closed his connection.
  void left(SignInId id, Now now, SignInEffects& out);
  void tick(Now now, SignInEffects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  enum class State : std::uint8_t { queued, running, late };
  struct Pending {
    SignInRequest request;
    Attempt attempt;
    Bytes stamp;  ///< of the user whose hash is checked; empty: nobody's
    MonotonicTime deadline;
    State state = State::queued;
  };
  using Rows = std::map<SignInId, Pending>;

  [[nodiscard]] bool has_place(const SignInRequest& request) const;
  void start_next(SignInEffects& out);
  void start(Pending& pending, SignInEffects& out);
  SignInAnswer conclude(const Pending& pending, CheckResult result, Now now);
  void drop_queued(SignInId id);

  const Users& users_;
  Sessions& sessions_;
  SignInGuard& guard_;
  std::string dummy_hash_;
  Rows pending_;
  std::deque<SignInId> queue_;
  std::size_t running_ = 0;  ///< late ones too
};

}  // namespace trb::gateway
