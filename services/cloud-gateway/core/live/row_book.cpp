#include "services/cloud-gateway/core/live/row_book.hpp"

#include <utility>

namespace trb::gateway {
namespace {

constexpr Duration kHeldBack = std::chrono::milliseconds(100);

}  // namespace

RowStream stream_of(RowKind kind) {
  switch (kind) {
    case RowKind::node:
    case RowKind::robot:
    case RowKind::run:
      return RowStream::fleet;
    case RowKind::alert:
      return RowStream::alerts;
    case RowKind::teleop:
      return RowStream::teleop;
    default:
      return RowStream::single;
  }
}

bool RowBook::put(const RowKey& key, RowContent content, Live live, Now now) {
  const auto at = rows_.find(key);
  if (at != rows_.end() && same_content(at->second.content, content)) {
    at->second.is_refused = false;
    confirm(key, live, now);
    return true;
  }
  const std::size_t size = size_of(content);
  const std::size_t before = at == rows_.end() ? 0 : at->second.size;
  if (is_budgeted(key) && !budgets_[key.node].hold(before, size)) {
    if (at != rows_.end()) at->second.is_refused = true, set_live(key, live, now);
    return false;
  }
  Row& row = insert(key);
  const bool at_once = row.live != live && row.live != Live::refused;
  const RowContent former = std::exchange(row.content, std::move(content));
  row.size = size;
  row.live = live;
  row.is_refused = false;
  row.heard = now;
  ++row.version;
  change(row, now, at_once);
  if (observer_ != nullptr) observer_->changed(row, former, now);
  return true;
}

Row& RowBook::insert(const RowKey& key) {
  Row& row = rows_[key];
  if (row.is_removed()) {
    row.key = key;
    removals_[index(stream_of(key.kind))].rows.erase(row.number);
    by_node_[key.node].insert(key);
  }
  return row;
}

void RowBook::confirm(const RowKey& key, Live live, Now now) {
  const auto at = rows_.find(key);
  if (at == rows_.end() || at->second.is_removed()) return;
  Row& row = at->second;
  if (row.is_refused) return set_live(key, live, now);
  row.heard = now;
  if (row.live != live) return set_live(key, live, now);
  if (now.mono - row.published.mono >= kPublishAge) change(row, now, false);
}

/// A node's change of state is published at once: the router limits how often that is.
void RowBook::set_live(const RowKey& key, Live live, Now now) {
  const auto at = rows_.find(key);
  if (at == rows_.end() || at->second.is_removed()) return;
  if (at->second.is_refused && live == Live::live) live = Live::refused;
  if (at->second.live == live) return;
  const bool at_once = live != Live::refused && at->second.live != Live::refused;
  at->second.live = live;
  change(at->second, now, at_once);
}

void RowBook::remove(const RowKey& key, Now now) {
  const auto at = rows_.find(key);
  if (at == rows_.end() || at->second.is_removed()) return;
  Row& row = at->second;
  if (is_budgeted(key)) budgets_[key.node].hold(row.size, 0);
  const RowContent former = std::exchange(row.content, std::monostate{});
  if (observer_ != nullptr) observer_->changed(row, former, now);
  row.is_refused = false;
  row.size = 0;
  row.heard = now;
  ++row.version;
  by_node_[key.node].erase(key);
  if (by_node_[key.node].empty()) by_node_.erase(key.node), budgets_.erase(key.node);
  held_back_.erase(key);
  publish(row, now);
  note_removed(row);
}

void RowBook::note_removed(const Row& row) {
  const RowStream stream = stream_of(row.key.kind);
  Removals& removals = removals_[index(stream)];
  removals.rows.emplace(row.number, row.key);
  if (removals.rows.size() <= kMaxRemoved) return;
  const auto first = removals.rows.begin();
  removals.oldest = first->first;
  orders_[index(stream)].erase(first->first);
  rows_.erase(first->second);
  removals.rows.erase(first);
}

void RowBook::change(Row& row, Now now, bool at_once) {
  const bool may = !is_budgeted(row.key) || budgets_[row.key.node].take(row.size, now.mono) || at_once;
  if (may) {
    held_back_.erase(row.key);
    return publish(row, now);
  }
  held_back_.insert(row.key);
  if (!next_) next_ = now.mono + kHeldBack;
}

void RowBook::publish(Row& row, Now now) {
  Order& order = orders_[index(stream_of(row.key.kind))];
  row.published = row.is_removed() ? now : row.heard;
  row.bytes.reset();
  auto node = order.extract(row.number);
  row.number = ++head_;
  if (node.empty()) {
    order.emplace_hint(order.end(), row.number, &row);
  } else {
    node.key() = row.number;
    order.insert(order.end(), std::move(node));
  }
}

void RowBook::tick(Now now) {
  if (!next_ || now.mono < *next_) return;
  next_.reset();
  const std::set<RowKey> waiting = std::exchange(held_back_, {});
  for (const RowKey& key : waiting) {
    if (const auto at = rows_.find(key); at != rows_.end()) change(at->second, now, false);
  }
}

const Row* RowBook::find(const RowKey& key) const {
  const Row* row = find_published(key);
  return row == nullptr || row->is_removed() ? nullptr : row;
}

const Row* RowBook::find_published(const RowKey& key) const {
  const auto at = rows_.find(key);
  return at == rows_.end() ? nullptr : &at->second;
}

void RowBook::each(RowKind kind, const std::function<void(const Row&)>& visit) const {
  for (auto at = rows_.lower_bound({kind, {}, {}}); at != rows_.end() && at->first.kind == kind; ++at) {
    if (!at->second.is_removed()) visit(at->second);
  }
}

std::vector<RowKey> RowBook::keys_of(const std::string& node) const {
  const auto at = by_node_.find(node);
  if (at == by_node_.end()) return {};
  return {at->second.begin(), at->second.end()};
}

}  // namespace trb::gateway
