// Each start, send or decision is done once, however often it is requested, and each repeat gets the same answer.
// README.md says what is on disk when, and what happens after a restart.
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

/// The user's name and the Idempotency-Key of the request.
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

/// A request as it is on disk; a new one with the same key replaces it.
struct StoredRequest {
  RequestKey key;
  Bytes digest;        ///< of method, path and body
  std::string effect;  ///< what to look for if it is not known whether it was done; chosen beforehand
  UtcTime since;       ///< steady
  std::optional<StoredAnswer> answer;
  bool operator==(const StoredRequest&) const = default;
};

/// A request that the clock's step has moved; all else of it stays.
struct MovedRequest {
  RequestKey key;
  UtcTime since;
};

/// Times are steady UTC.
class Idempotency {
 public:
  static constexpr std::size_t kMaxKey = 255;
  static constexpr std::size_t kMaxEffect = 1024;
  static constexpr std::size_t kMaxOfUser = 5000;
  static constexpr std::size_t kMaxInAll = 20'000;
  static constexpr std::size_t kAlwaysOfUser = 20;                  ///< that others cannot take from him
  static constexpr std::size_t kShortAnswer = 4096;                 ///< always kept
  static constexpr std::size_t kMaxAnswer = std::size_t{1} << 16U;  ///< kept while kMaxLong has room
  static constexpr std::size_t kMaxLong = std::size_t{1} << 22U;    ///< of all answers over kShortAnswer together
  static constexpr Duration kLife = std::chrono::hours(24);
  static constexpr Duration kWait = std::chrono::seconds(1);

  /// Store it, then act.
  struct Act {
    StoredRequest store;
  };
  struct Wait {
    Duration retry_after{};
  };
  using Begun = std::variant<Act, StoredAnswer, Wait>;

  /// Instead of all that were known: the requests as this gateway and others have left them on disk. One without an
  /// answer is unsure.
  void replace(const std::vector<StoredRequest>& requests);
  [[nodiscard]] const StoredRequest* find(const RequestKey& key) const;
  /// Errors: bad_value (no key of 1 to 255 visible characters), conflict (the key was used for another request),
  /// too_large (the effect), queue_full.
  Result<Begun> begin(const RequestKey& key, const Bytes& digest, std::string effect, UtcTime now);
  /// The request was done or refused: store the result, then answer. Nullopt: no such request runs. An answer that is
  /// too long (see the bounds) is kept without its body.
  std::optional<StoredRequest> finish(const RequestKey& key, StoredAnswer answer);
  /// What an error of the fleet says of a request that was on its way: nothing was done, and it may be done later. Only
  /// what a router refuses before it delivers says so; of a robot that was lost (robot_offline) nobody knows.
  static bool means_not_done(Errc code);
  /// The request could not be stored, or was provably not done: frees the key; remove it from the disk. False: the key
  /// is unknown or answered.
  bool release(const RequestKey& key);
  /// Intents that may or may not have been done before a restart: find out, then call finish() or release(). `before`:
  /// those alone that began before it, for another gateway may be at work on the others.
  [[nodiscard]] std::vector<StoredRequest> unsure(std::optional<UtcTime> before = std::nullopt) const;
  /// Expired keys: remove them from the disk.
  std::vector<RequestKey> take_expired(UtcTime now);
  /// The clock has stepped: a key is kept for as long as it would have been. Store those that it returns.
  std::vector<MovedRequest> move(const SteadyStep& step);

 private:
  struct Known {
    StoredRequest stored;
    bool is_unsure = false;
  };
  [[nodiscard]] static Result<Begun> repeat(const Known& known, const Bytes& digest);
  [[nodiscard]] Status check(const RequestKey& key, const std::string& effect) const;
  void put(const StoredRequest& request);
  void erase(const RequestKey& key);

  std::map<RequestKey, Known> requests_;
  std::map<std::string, std::size_t> by_user_;
  std::set<std::pair<UtcTime, RequestKey>> answered_;  ///< the oldest first
  std::size_t long_bytes_ = 0;                         ///< of answers over kShortAnswer
};

}  // namespace trb::gateway
