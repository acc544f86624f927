// How much each robot and each of its sensors has in the history: whether what is too much goes from one of them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace trb::gateway {

/// One stream of entries: a robot's own (no sensor), or those of one of its sensors.
struct HistoryStream {
  std::string node;
  std::string sensor;
  bool operator==(const HistoryStream&) const = default;
};

/// A node that fills the history pushes out its own entries, whatever it fills it with. Up to twice what each would
/// have if all had the same, or half of it all if there are few, the oldest entry goes, whosever it is: pages of a file
/// that have entries of many nodes become free together.
class HistorySizes {
 public:
  void add(const HistoryStream& stream, std::int64_t bytes);
  void remove(const HistoryStream& stream, std::int64_t bytes);
  /// It has no entry any more.
  void forget(const HistoryStream& stream);
  /// The largest stream of the node that has the most, if that is more than its share.
  [[nodiscard]] std::optional<HistoryStream> over_share() const;

 private:
  struct Node {
    std::int64_t bytes = 0;
    std::map<std::string, std::int64_t> streams;  ///< by sensor
  };
  std::map<std::string, Node> nodes_;
  std::int64_t bytes_ = 0;
};

}  // namespace trb::gateway
