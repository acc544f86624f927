// A start, a send, a decision is done once however often it is asked for, and answered alike each time. README.md has
// what is on disk when, and what a restart makes of it.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/base/steady_time.hpp"

namespace trb::gateway {

/// A user's name and the Idempotency-Key that he has sent.
struct RequestKey {
  std::string user;
  std::string key;
  auto operator<=>(const RequestKey&) const = default;
};

struct StoredAnswer {
  std::uint16_t status = 0;
  Bytes body;
  bool operator==(const StoredAnswer&) const = default;
};

/// What is on disk of a request; one with the same key takes the place of the one before.
struct StoredRequest {
  RequestKey key;
  Bytes digest;        ///< of method, path and body
  std::string effect;  ///< what to look for if nobody knows whether it was done: chosen before it is
  UtcTime since;       ///< steady
  std::optional<StoredAnswer> answer;
  bool operator==(const StoredRequest&) const = default;
};

class Idempotency {
 public:
  static constexpr std::size_t kMaxKey = 255;
  static constexpr std::size_t kMaxEffect = 1024;
  static constexpr std::size_t kMaxOfUser = 5000;
  static constexpr std::size_t kMaxInAll = 20'000;
  static constexpr std::size_t kMaxAnswer = 4096;
  static constexpr Duration kLife = std::chrono::hours(24);
  static constexpr Duration kWait = std::chrono::seconds(1);

  /// To be stored, then acted on.
  struct Act {
    StoredRequest store;
  };
  struct Wait {
    Duration retry_after{};
  };
  using Begun = std::variant<Act, StoredAnswer, Wait>;

  /// What was on disk; `last`: the steady time that was kept last. What has no answer is unsure.
  void restore(const std::vector<StoredRequest>& requests, UtcTime last);
  /// Errors: bad_value (no key of 1 to 255 visible characters), conflict (the key was used for another request),
  /// too_large (the effect), queue_full.
  Result<Begun> begin(const RequestKey& key, const Bytes& digest, std::string effect, Now now);
  /// It was done, or refused: to be stored before it is answered. Nothing: no such request runs. An answer over
  /// kMaxAnswer is kept without its body.
  std::optional<StoredRequest> finish(const RequestKey& key, StoredAnswer answer);
  /// It could not be stored, or it provably was not done: the key is free, and to be removed from the disk. False: it
  /// is not known, or answered.
  bool release(const RequestKey& key);
  /// Intents of which a restart does not know whether they were done: to be looked for, then finish() or release().
  [[nodiscard]] std::vector<StoredRequest> unsure() const;
  /// The keys whose time is over: to be removed from the disk.
  std::vector<RequestKey> take_expired(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline(Now now) const;
  /// To be kept now and then, for restore().
  UtcTime steady_time(Now now) { return time_.at(now); }

 private:
  struct Known {
    StoredRequest stored;
    bool is_unsure = false;
  };
  [[nodiscard]] static Result<Begun> repeat(const Known& known, const Bytes& digest);
  [[nodiscard]] Status check(const RequestKey& key, const std::string& effect) const;
  void erase(const RequestKey& key);

  std::map<RequestKey, Known> requests_;
  std::map<std::string, std::size_t> by_user_;
  std::set<std::pair<UtcTime, RequestKey>> answered_;  ///< the oldest first
  SteadyTime time_;
};

}  // namespace trb::gateway
