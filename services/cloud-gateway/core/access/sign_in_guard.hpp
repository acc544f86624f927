// Who may try a password now.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "services/cloud-gateway/core/access/failure_table.hpp"

namespace trb::gateway {

/// Somebody forgets a password some times; a hall's operators may share one address.
constexpr FailureRule kUserFailures{.free = 5, .most = std::chrono::minutes(15), .room = 4096};
constexpr FailureRule kSourceFailures{.free = 20, .most = std::chrono::minutes(15), .room = 4096};
constexpr FailureRule kPairFailures{.free = 5, .most = std::chrono::minutes(1), .room = 4096};
constexpr std::size_t kKnownOfUser = 8;

/// A try that has begun.
struct Attempt {
  std::string user;
  std::string source;
  bool known = false;
};

/// Limits against guessing, by the name that was given (whether there is such a user or not) and by the address.
///
/// the pair of name and address | is judged by
/// -----------------------------|---------------------------------------------------------------------
/// unknown                      | the name's failures and the address's, both from unknown pairs alone
/// known (signed in before)     | its own failures, and nothing else
///
/// So who guesses a name from elsewhere makes strangers wait, not the user at his desk; who guesses from the user's own
/// address makes him wait for a minute at most. A success takes back its own try and no other: nobody clears
/// an address by signing in as himself. A try in a wait is refused and not counted.
class SignInGuard {
 public:
  [[nodiscard]] bool is_known(std::string_view user, std::string_view source) const;
  /// 0: he may try.
  [[nodiscard]] Duration wait(std::string_view user, std::string_view source, MonotonicTime now) const;
  /// Counts it as a failure until it is known to be none.
  Attempt begin(std::string_view user, std::string_view source, MonotonicTime now);
  void succeeded(const Attempt& attempt);
  /// No password was checked.
  void cancel(const Attempt& attempt);

  /// Known pairs outlive a restart: else one that comes during an attack would lock out everybody.
  void restore_known(const std::string& user, const std::string& source) { remember(user, source); }
  /// The user was removed.
  void forget_user(const std::string& user);
  /// By user, the last one first.
  [[nodiscard]] const std::map<std::string, std::vector<std::string>, std::less<>>& known() const { return known_; }
  /// What is kept of failures, for a test of its bounds.
  [[nodiscard]] std::size_t rows() const { return users_.size() + sources_.size() + pairs_.size(); }

 private:
  void remember(const std::string& user, const std::string& source);

  FailureTable users_{kUserFailures};
  FailureTable sources_{kSourceFailures};
  FailureTable pairs_{kPairFailures};
  std::map<std::string, std::vector<std::string>, std::less<>> known_;
};

}  // namespace trb::gateway
