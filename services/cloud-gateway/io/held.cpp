#include "services/cloud-gateway/io/held.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

namespace trb::gateway {
namespace {

template <class Row>
void move_newest(std::vector<Change<Row>>& from, std::vector<Change<Row>>& to) {
  for (Change<Row>& one : std::exchange(from, {})) {
    std::erase_if(to, [&](const Change<Row>& is) { return is.key == one.key; });
    to.push_back(std::move(one));
  }
}

/// Of requests that are dropped, or have moved again.
void erase_moves(const RequestKey& of, std::vector<MovedRequest>& from) {
  std::erase_if(from, [&](const MovedRequest& one) { return one.key == of; });
}

void move_moves(std::vector<MovedRequest>& from, std::vector<MovedRequest>& to) {
  for (MovedRequest& one : std::exchange(from, {})) {
    erase_moves(one.key, to);
    to.push_back(std::move(one));
  }
}

/// An intent is none: what was not stored before it was done must not be found as if it had been.
void move_answers(StoreBatch& from, StoreBatch& to) {
  for (RequestKey& key : std::exchange(from.dropped_requests, {})) {
    std::erase_if(to.requests, [&](const StoredRequest& is) { return is.key == key; });
    erase_moves(key, to.moved_requests);
    std::erase(to.dropped_requests, key);
    to.dropped_requests.push_back(std::move(key));
  }
  const auto first = std::stable_partition(from.requests.begin(), from.requests.end(),
                                           [](const StoredRequest& one) { return !one.answer; });
  for (auto at = first; at != from.requests.end(); ++at) {
    std::erase_if(to.requests, [&](const StoredRequest& is) { return is.key == at->key; });
    to.requests.push_back(std::move(*at));
  }
  from.requests.erase(first, from.requests.end());
}

template <class T>
void put_behind(std::vector<T>& all, const std::vector<T>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

}  // namespace

/// Of a batch with changed users the sessions are part of the decision: who has a new password signs in anew.
void Held::take_from(StoreBatch& batch, Besides besides) {
  if (batch.users.empty()) move_newest(batch.sessions, waits_.sessions);
  move_answers(batch, waits_);
  move_moves(batch.moved_requests, waits_.moved_requests);
  put_behind(waits_.heads, std::exchange(batch.heads, {}));
  if (besides == Besides::nothing) return;
  move_newest(batch.acknowledged, waits_.acknowledged);
  move_newest(batch.shelves, waits_.shelves);
  if (besides == Besides::moved) move_newest(batch.tokens, waits_.tokens);
}

StoreBatch Held::before(const StoreBatch& batch) const {
  StoreBatch out = waits_;
  put_behind(out.users, batch.users);
  put_behind(out.sessions, batch.sessions);
  put_behind(out.tokens, batch.tokens);
  // All that is dropped goes before all that is put.
  for (const RequestKey& key : batch.dropped_requests) {
    std::erase_if(out.requests, [&](const StoredRequest& one) { return one.key == key; });
    erase_moves(key, out.moved_requests);
  }
  put_behind(out.requests, batch.requests);
  put_behind(out.dropped_requests, batch.dropped_requests);
  put_behind(out.moved_requests, batch.moved_requests);
  put_behind(out.scenarios, batch.scenarios);
  put_behind(out.acknowledged, batch.acknowledged);
  put_behind(out.shelves, batch.shelves);
  put_behind(out.audit, batch.audit);
  put_behind(out.heads, batch.heads);
  out.steady = batch.steady;
  return out;
}

}  // namespace trb::gateway
