#include "services/router/core/lane_table.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "common/base/address.hpp"

namespace trb::router {
namespace {

/// The address of the other side's lane: a node that was dialled is reached at the dialled host, whatever its Hello
/// names.
std::string lane_address(const Link& link, const Hello& hello) {
  if (hello.lane.empty() || !link.dialled || !is_numeric_endpoint(link.address)) return hello.lane;
  const auto port = hello.lane.rfind(':');
  return link.address.substr(0, link.address.rfind(':')) + (port == std::string::npos ? "" : hello.lane.substr(port));
}

}  // namespace

bool Spare::take(std::size_t size, MonotonicTime now) {
  if (now >= end_) {
    messages_ = 0;
    bytes_ = 0;
    end_ = now + std::chrono::seconds(1);
  }
  if (messages_ >= kMessages || bytes_ + size > kBytes) return false;
  ++messages_;
  bytes_ += size;
  return true;
}

Lane* LaneTable::row(LinkId link) {
  return table_.link(link) == nullptr ? nullptr : &rows_[link];
}

Lane LaneTable::of(LinkId link) const {
  const auto at = rows_.find(link);
  return at == rows_.end() ? Lane{} : at->second;
}

bool LaneTable::listens(LinkId link) const {
  const auto at = rows_.find(link);
  return at != rows_.end() && at->second.listens;
}

// ---- the other side's lane, dialled

void LaneTable::open(const Link& link, const Hello& hello, Now now) {
  Lane& lane = rows_[link.id];
  lane.address = lane_address(link, hello);
  if (!lane.address.empty()) dials_.set(link.id, lane.dial_at, now.mono + kLaneAfter);
}

void LaneTable::tick(Now now, Effects& out) {
  drop_rows_without_link();
  std::vector<LinkId> due = dials_.due(now.mono);
  std::ranges::sort(due);
  for (const LinkId id : due) {
    Lane& lane = rows_.at(id);
    dials_.set(id, lane.dial_at, std::nullopt);
    out.add(DialLane{id, lane.address, table_.link(id)->key});
  }
}

void LaneTable::drop_rows_without_link() {
  if (std::exchange(removed_, table_.removed()) == table_.removed()) return;
  for (auto at = rows_.begin(); at != rows_.end();) {
    if (std::as_const(table_).link(at->first) != nullptr) {
      ++at;
    } else {
      dials_.set(at->first, at->second.dial_at, std::nullopt);
      at = rows_.erase(at);
    }
  }
}

std::optional<MonotonicTime> LaneTable::next_deadline() const {
  const auto next = std::ranges::find_if(
      dials_.rows(), [&](const auto& row) { return std::as_const(table_).link(row.second) != nullptr; });
  return next == dials_.rows().end() ? std::nullopt : std::optional(next->first);
}

void LaneTable::on_connected(LinkId link, Now now) {
  if (Lane* lane = row(link)) lane->connected = now.mono;
}

void LaneTable::on_ended(LinkId link, LinkEndReason how, Now now, Effects& out) {
  Lane* lane = row(link);
  if (lane == nullptr) return;
  out.count("lane." + std::string(name_of(how)));
  // One that is cut again and again is dialled less and less often.
  if (lane->connected && now.mono - *lane->connected > node_.config().timing.lease) lane->wait = {};
  lane->connected.reset();
  lane->wait = std::clamp(lane->wait * 2, kLaneFirst, kLaneMost);
  dials_.set(link, lane->dial_at, now.mono + lane->wait);
}

void LaneTable::on_incomplete(LinkId link, Effects& out) {
  Lane* lane = row(link);
  if (lane == nullptr) return;
  lane->connected.reset();
  out.count("cut.incomplete");
  out.log(LogLevel::warning, "incomplete",
          table_.link(link)->peer +
              ": its lane sent parts of a message without end: not listened to until its link has ended");
}

// ---- this node's lane

Link* LaneTable::listener(BytesView key) {
  Link* link = table_.linked_by_key(key);
  return link == nullptr || of(link->id).barred ? nullptr : link;
}

bool LaneTable::admit(BytesView key, Effects& out) {
  if (listener(key) != nullptr) return true;
  out.count("refused.lane_key");
  return false;
}

std::optional<LinkId> LaneTable::on_listen(BytesView key, BytesView topic, Effects& out) {
  const Link* link = listener(key);
  if (link == nullptr) {
    out.count("refused.lane_key");
    return std::nullopt;
  }
  if (topic != topic_of(link->peer)) {
    out.count("refused.lane_topic");
    out.log(LogLevel::warning, "lane_topic", link->peer + " subscribes to what is not meant for it");
    return std::nullopt;
  }
  rows_[link->id].listens = true;
  return link->id;
}

void LaneTable::on_listener_gone(LinkId link) {
  if (Lane* lane = row(link)) lane->listens = false;
}

void LaneTable::bar(BytesView key, Effects& out) {
  out.count("refused.lane_word");
  if (const Link* link = table_.linked_by_key(key)) bar(link->id, out);
}

void LaneTable::bar(LinkId id, Effects& out) {
  const Link* link = table_.link(id);
  if (link == nullptr) return;
  Lane& lane = rows_[id];
  lane.barred = true;
  lane.listens = false;
  out.log(LogLevel::warning, "lane_word",
          link->peer + " said something to the lane, which is for listening: kept out of it until its link has ended");
}

}  // namespace trb::router
