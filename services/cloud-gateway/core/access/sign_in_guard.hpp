// Rate limit: who may try a password now.
#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "services/cloud-gateway/core/access/failure_table.hpp"

namespace trb::gateway {

/// People mistype passwords; a hall's operators may share one address.
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

/// Limits password guessing by the given name (whether the user exists or not) and by the address.
///
/// the pair of name and address | is limited by
/// -----------------------------|---------------------------------------------------------------------
/// unknown                      | the failures of the name and of the address, both of unknown pairs alone
/// known (signed in before)     | its own failures alone
///
/// So guessing from elsewhere makes strangers wait, not the user at his desk. Guessing from the user's own address
/// makes him wait for a minute at most. A success takes back its own try alone: nobody clears an address by
/// signing in as himself. A try during a wait is refused and not counted.
class SignInGuard {
 public:
  [[nodiscard]] bool is_known(std::string_view user, std::string_view source) const;
  /// 0: no wait.
  [[nodiscard]] Duration wait(std::string_view user, std::string_view source, MonotonicTime now) const;
  /// Counts the attempt as a failure until it succeeds or is cancelled.
  Attempt begin(std::string_view user, std::string_view source, MonotonicTime now);
  void succeeded(const Attempt& attempt);
  /// No password was checked.
  void cancel(const Attempt& attempt);

  /// Known pairs survive a restart: else a restart during an attack would lock everybody out.
  void restore_known(const std::string& user, const std::string& source) { remember(user, source); }
  /// The user was removed.
  void forget_user(const std::string& user);
  /// Addresses by user, the newest first.
  [[nodiscard]] const std::map<std::string, std::vector<std::string>, std::less<>>& known() const { return known_; }
  /// Number of stored failure rows, to test the bounds.
  [[nodiscard]] std::size_t rows() const { return users_.size() + sources_.size() + pairs_.size(); }

 private:
  void remember(const std::string& user, const std::string& source);

  FailureTable users_{kUserFailures};
  FailureTable sources_{kSourceFailures};
  FailureTable pairs_{kPairFailures};
  std::map<std::string, std::vector<std::string>, std::less<>> known_;
};

}  // namespace trb::gateway
