// What this node must keep over a restart and could not store on its disk: shown to people, tried again, and not
// acknowledged.
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"

namespace trb::router {

enum class Kept : std::uint8_t { update, certificate, boot };

constexpr Duration kStoreAgain = std::chrono::seconds(10);

class Unstored {
 public:
  /// The shell was ordered to store it.
  void add(Kept what) { waiting_.insert(what); }
  /// It has stored it, or could not.
  void answered(Kept what, const Status& done, MonotonicTime now);

  /// The shell has not answered yet.
  [[nodiscard]] bool waits() const { return !waiting_.empty(); }
  /// Why what the authority has signed is not on disk, and what to do; nothing if it is, as far as known.
  [[nodiscard]] std::optional<Error> update_failure() const;
  /// For people: what is not on disk, and what to do; empty if all is.
  [[nodiscard]] std::string note() const;

  [[nodiscard]] std::optional<MonotonicTime> next() const { return again_; }
  /// What must be tried again now.
  std::vector<Kept> take_due(MonotonicTime now);

 private:
  std::set<Kept> waiting_;
  std::map<Kept, Error> failed_;
  std::optional<MonotonicTime> again_;
};

}  // namespace trb::router
