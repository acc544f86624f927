#include "services/cloud-gateway/core/live/block_maker.hpp"

#include <algorithm>

namespace trb::gateway {

const SharedBytes& BlockMaker::bytes_of(const Row& row) {
  if (row.bytes == nullptr) {
    row.bytes = std::make_shared<const Bytes>(encoder_.encode(row));
    ++encoded_;
  }
  return row.bytes;
}

/// Visits rows in order of number until `visit` returns false.
template <class Visit>
void BlockMaker::each_behind(const Topic& topic, std::uint64_t from, Visit visit) const {
  const RowStream stream = stream_of(topic);
  if (stream != RowStream::single) {
    const RowBook::Order& order = book_.order(stream);
    for (auto at = order.upper_bound(from); at != order.end() && visit(*at->second);) ++at;
    return;
  }
  std::vector<const Row*> rows;
  for (const RowKey& key : keys_of(topic)) {
    const Row* row = book_.find_published(key);
    if (row != nullptr && row->number > from) rows.push_back(row);
  }
  std::sort(rows.begin(), rows.end(), [](const Row* a, const Row* b) { return a->number < b->number; });
  for (auto at = rows.begin(); at != rows.end() && visit(**at);) ++at;
}

SharedBlock BlockMaker::block(const Topic& topic, std::uint64_t from, bool is_snapshot) {
  if (made_at_ != book_.head()) made_.clear();
  made_at_ = book_.head();
  const auto [at, is_new] = made_.try_emplace({topic, from, is_snapshot});
  if (is_new) at->second = make(topic, from, is_snapshot);
  return at->second;
}

SharedBlock BlockMaker::make(const Topic& topic, std::uint64_t from, bool is_snapshot) {
  auto out = std::make_shared<Block>();
  out->topic = topic;
  out->is_snapshot = is_snapshot;
  out->begins = is_snapshot && from == 0;
  std::uint64_t last = from;
  each_behind(topic, from, [&](const Row& row) {
    if (out->begins && row.is_removed()) return last = row.number, true;
    const SharedBytes& bytes = bytes_of(row);
    out->more = !out->rows.empty() && out->size + bytes->size() > kMaxBlock;
    if (out->more) return false;
    out->rows.push_back(bytes);
    out->size += bytes->size();
    last = row.number;
    return true;
  });
  out->to = out->more ? last : book_.head();
  if (out->rows.empty() && !is_snapshot) return nullptr;
  return out;
}

std::size_t BlockMaker::waiting(const Topic& topic, std::uint64_t from, std::size_t enough) {
  std::size_t out = 0;
  each_behind(topic, from, [&](const Row& row) { return (out += bytes_of(row)->size()) < enough; });
  return out;
}

bool BlockMaker::is_too_old(const Topic& topic, std::uint64_t from) const {
  return topic.kind != TopicKind::messages && from < book_.oldest(stream_of(topic));
}

}  // namespace trb::gateway
