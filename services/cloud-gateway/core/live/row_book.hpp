// Every row once, in the order in which it was told last. Who has seen the book up to a number lacks what stands behind
// it: each row once, with its newest value.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "services/cloud-gateway/core/live/node_budget.hpp"
#include "services/cloud-gateway/core/live/row.hpp"

namespace trb::gateway {

/// Rows that are read together, in one order of numbers.
enum class RowStream : std::uint8_t { fleet = 0, alerts, teleop, single };
RowStream stream_of(RowKind kind);

class RowBook {
 public:
  static constexpr std::size_t kMaxRemoved = 1000;
  static constexpr Duration kTellAge = std::chrono::seconds(5);

  using Order = std::map<std::uint64_t, const Row*>;

  /// The row is `content` from now on. False: its node is over its budget, the row has its old content and is
  /// `refused`.
  bool put(const RowKey& key, RowContent content, Live live, Now now);
  /// Somebody has said again what is known of it.
  void confirm(const RowKey& key, Live live, Now now);
  void set_live(const RowKey& key, Live live, Now now);
  void remove(const RowKey& key, Now now);
  /// Tells what was held back.
  void tick(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return next_; }

  /// nullptr: it is not there, or not any more.
  [[nodiscard]] const Row* find(const RowKey& key) const;
  /// Also one that was removed lately.
  [[nodiscard]] const Row* find_told(const RowKey& key) const;
  [[nodiscard]] const Order& order(RowStream stream) const { return orders_[index(stream)]; }
  /// The number that was given last.
  [[nodiscard]] std::uint64_t head() const { return head_; }
  /// Who has seen less than this may lack a removal that is forgotten.
  [[nodiscard]] std::uint64_t oldest(RowStream stream) const { return removals_[index(stream)].oldest; }
  /// By key, those of that kind; `visit` may not change the book.
  void each(RowKind kind, const std::function<void(const Row&)>& visit) const;
  /// The keys of one node's rows.
  [[nodiscard]] std::vector<RowKey> keys_of(const std::string& node) const;

 private:
  /// What was removed lately, of one stream: a node whose sensors come and go takes no removal from the fleet's.
  struct Removals {
    std::map<std::uint64_t, RowKey> rows;
    std::uint64_t oldest = 0;
  };
  static std::size_t index(RowStream stream) { return static_cast<std::size_t>(stream); }
  void change(Row& row, Now now, bool at_once);
  void tell(Row& row, Now now);
  void note_removed(const Row& row);
  Row& insert(const RowKey& key);
  [[nodiscard]] bool is_budgeted(const RowKey& key) const { return !key.node.empty() && key.kind != RowKind::teleop; }

  std::map<RowKey, Row> rows_;
  std::array<Order, 4> orders_;
  std::map<std::string, std::set<RowKey>> by_node_;
  std::map<std::string, NodeBudget> budgets_;
  std::array<Removals, 4> removals_;
  std::set<RowKey> held_back_;
  std::optional<MonotonicTime> next_;
  std::uint64_t head_ = 0;
};

}  // namespace trb::gateway
