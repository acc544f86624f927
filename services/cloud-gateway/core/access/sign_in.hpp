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

using SignInId = std::uint64_t;  ///< the request's, chosen by the shell; never used twice

struct SignInRequest {
  SignInId id = 0;
  std::string user;
  std::string password;
  std::string source;       ///< the client's address; for IPv6 its /64
  std::string old_session;  ///< the browser's previous one: it ends when the new one begins
};

enum class SignInOutcome : std::uint8_t {
  signed_in,
  refused,      ///< no such user, wrong password, disabled: the answer does not say which
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
  std::int64_t retry_after_s = 0;     ///< for wait, busy and unavailable
  std::optional<NewSession> session;  ///< for signed_in
};

/// Does the password match the hash? Answer with SignIn::checked() and the same id.
struct PasswordCheck {
  SignInId id = 0;
  std::string hash;
  std::string password;
};
enum class CheckResult : std::uint8_t { right, wrong, failed };

/// What the shell must do.
struct SignInEffects {
  std::vector<PasswordCheck> checks;
  std::vector<SignInAnswer> answers;
};

/// A check takes 70 ms of a core and 64 MB: two at once leave the loop a core.
constexpr std::size_t kChecksAtOnce = 2;
/// So the last check in the queue waits for half a second.
constexpr std::size_t kQueuedChecks = 16;
/// Places in the queue that are kept for known pairs of name and address.
constexpr std::size_t kPlacesForKnown = 4;
/// Running and queued: for the unknown pairs of one address, and for one known pair.
constexpr std::size_t kChecksOfSource = 4;
constexpr Duration kSignInTime = std::chrono::seconds(10);
constexpr std::int64_t kBusyRetry_s = 2;

/// -       | request, its name or address has to wait    | answered `wait`
/// -       | request, no place is left                   | answered `busy`
/// -       | request                                     | queued; running if fewer than two run
/// queued  | a place is free                             | running, with the hash as it is now
/// queued  | 10 s, or the client leaves                  | -, `unavailable`; the try does not count
/// running | right, and the user is unchanged            | -, `signed_in`; with a new session
/// running | wrong; or right, and he was changed         | -, `refused`
/// running | failed                                      | -, `unavailable`; the try does not count
/// running | 10 s, or the client leaves                  | late: keeps its place, as the check still runs
/// late    | any result                                  | -, no session
/// -       | unknown or repeated result                  | nothing
/// For an unknown or disabled user the check runs too, against a hash that no password matches, and the answer is the
/// same. `now.utc` is steady.
class SignIn {
 public:
  /// `dummy_hash` is made with the same parameters as all others.
  SignIn(const Users& users, Sessions& sessions, SignInGuard& guard, std::string dummy_hash)
      : users_(users), sessions_(sessions), guard_(guard), dummy_hash_(std::move(dummy_hash)) {}

  void request(SignInRequest request, Now now, SignInEffects& out);
  void checked(SignInId id, CheckResult result, Now now, SignInEffects& out);
  /// The client has closed its connection.
  void left(SignInId id, Now now, SignInEffects& out);
  void tick(Now now, SignInEffects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

 private:
  enum class State : std::uint8_t { queued, running, late };
  struct Pending {
    SignInRequest request;
    Attempt attempt;
    Bytes stamp;  ///< of the user whose hash is checked; empty: no user
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
  std::size_t running_ = 0;  ///< including late ones
};

}  // namespace trb::gateway
