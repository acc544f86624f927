// Changes that the store must write, in their order.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace trb::gateway {

/// The row's new value; no row: it was removed.
template <class Row>
struct Change {
  std::string key;
  std::optional<Row> row;
};

template <class Row>
class ChangeList {
 public:
  void put(std::string key, Row row) { changes_.push_back({std::move(key), std::move(row)}); }
  void drop(std::string key) { changes_.push_back({std::move(key), std::nullopt}); }
  [[nodiscard]] const std::vector<Change<Row>>& pending() const { return changes_; }
  std::vector<Change<Row>> take() { return std::exchange(changes_, {}); }

 private:
  std::vector<Change<Row>> changes_;
};

}  // namespace trb::gateway
