// Every row once, in the order of its last publication. A client at a number lacks the rows after that number: each
// row once, with its newest value.
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

/// Rows that are read together, ordered by number.
enum class RowStream : std::uint8_t { fleet = 0, alerts, teleop, single };
RowStream stream_of(RowKind kind);

/// Notified of each change of a row's content, also of its removal; `before`: std::monostate for a new row.
class RowObserver {
 public:
  RowObserver() = default;
  RowObserver(const RowObserver&) = delete;
  RowObserver& operator=(const RowObserver&) = delete;
  virtual ~RowObserver() = default;
  virtual void changed(const Row& row, const RowContent& before, Now now) = 0;
};

class RowBook {
 public:
  static constexpr std::size_t kMaxRemoved = 1000;
  static constexpr Duration kPublishAge = std::chrono::seconds(5);

  using Order = std::map<std::uint64_t, const Row*>;

  /// The observer must outlive the book; it must not change it.
  void observe(RowObserver& observer) { observer_ = &observer; }
  /// Sets the row's content. False: its node is over its budget, the row keeps its old content and becomes
  /// `refused`.
  bool put(const RowKey& key, RowContent content, Live live, Now now);
  /// The same content was received again.
  void confirm(const RowKey& key, Live live, Now now);
  void set_live(const RowKey& key, Live live, Now now);
  void remove(const RowKey& key, Now now);
  /// Publishes rows that were held back.
  void tick(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return next_; }

  /// nullptr: no such row, or it was removed.
  [[nodiscard]] const Row* find(const RowKey& key) const;
  /// Finds recently removed rows too.
  [[nodiscard]] const Row* find_published(const RowKey& key) const;
  [[nodiscard]] const Order& order(RowStream stream) const { return orders_[index(stream)]; }
  /// The last number given.
  [[nodiscard]] std::uint64_t head() const { return head_; }
  /// A client below this number may lack a removal that is forgotten.
  [[nodiscard]] std::uint64_t oldest(RowStream stream) const { return removals_[index(stream)].oldest; }
  /// Visits the rows of this kind by key; `visit` must not change the book.
  void each(RowKind kind, const std::function<void(const Row&)>& visit) const;
  /// The keys of one node's rows.
  [[nodiscard]] std::vector<RowKey> keys_of(const std::string& node) const;

 private:
  /// Recent removals of one stream. So a node whose sensors come and go pushes out no removal of the fleet stream.
  struct Removals {
    std::map<std::uint64_t, RowKey> rows;
    std::uint64_t oldest = 0;
  };
  static std::size_t index(RowStream stream) { return static_cast<std::size_t>(stream); }
  void change(Row& row, Now now, bool at_once);
  void publish(Row& row, Now now);
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
  RowObserver* observer_ = nullptr;
};

}  // namespace trb::gateway
