#include "services/cloud-gateway/core/live/client_feed.hpp"

#include <algorithm>
#include <utility>

namespace trb::gateway {

Status ClientFeed::subscribe(const Topic& topic, std::uint64_t from, std::optional<NoticeKind> notice) {
  if (topics_.contains(topic)) return Done{};
  if (topics_.size() == kMaxTopics) {
    return fail(Errc::queue_full, "topic: this client has " + std::to_string(kMaxTopics), "unsubscribe from one");
  }
  const bool is_snapshot = from == 0 && topic.kind != TopicKind::messages;
  topics_[topic] = {from, is_snapshot};
  if (notice) notices_.push_back({*notice, topic});
  // What it has of a topic that restarts is of no number of ours.
  if (notice) known_ = 0;
  if (topic.kind != TopicKind::messages && from != 0) known_ = std::min(known_.value_or(from), from);
  behind_ = true;
  return Done{};
}

void ClientFeed::unsubscribe(const Topic& topic) {
  topics_.erase(topic);
  // Or they would grow without a bound: a client may come and go, and read nothing.
  std::erase_if(notices_, [&](const Notice& one) { return one.topic == topic; });
}

bool ClientFeed::has(TopicKind kind) const {
  return std::any_of(topics_.begin(), topics_.end(), [kind](const auto& one) { return one.first.kind == kind; });
}

std::vector<Topic> ClientFeed::topics() const {
  std::vector<Topic> out;
  for (const auto& [topic, seen] : topics_) out.push_back(topic);
  return out;
}

bool ClientFeed::pump(BlockMaker& blocks, const MessageLane& lane, const RowSources& silent, Now now) {
  if (waiting_) drop_if_full(blocks, now);
  behind_ = false;
  skipped_ = waiting_.has_value();
  if (skipped_) return false;
  Frame frame;
  frame.head = blocks.book().head();
  frame.time = now.utc;
  frame.silent = silent;
  fill_blocks(frame, blocks);
  whole_ = is_whole(frame);
  // The client resumes every topic at this number, also the one that is not in the frame.
  if (next_) frame.head = known_.value_or(0);
  fill_messages(frame, lane);
  frame.notices = std::exchange(notices_, {});
  if (frame.is_empty() && made_at_ && now.mono - *made_at_ < kQuiet) return false;
  frame.count = ++count_;
  made_at_ = looked_at_ = now.mono;
  waiting_ = std::move(frame);
  return true;
}

std::optional<Frame> ClientFeed::take() {
  behind_ = behind_ || skipped_;
  if (waiting_ && whole_) known_ = waiting_->head;
  return std::exchange(waiting_, std::nullopt);
}

bool ClientFeed::is_whole(const Frame& frame) const {
  return !next_ &&
         std::none_of(frame.blocks.begin(), frame.blocks.end(), [](const SharedBlock& one) { return one->more; });
}

/// Topics that had no room in the last frame come first in this one.
void ClientFeed::fill_blocks(Frame& frame, BlockMaker& blocks) {
  const auto first = next_ ? topics_.lower_bound(*next_) : topics_.begin();
  next_.reset();
  const auto fill = [&](auto at, auto end) {
    for (; at != end; ++at) {
      if (at->first.kind != TopicKind::messages) fill_block(frame, at->first, at->second, blocks);
    }
  };
  fill(first, topics_.end());
  fill(topics_.begin(), first);
}

void ClientFeed::fill_block(Frame& frame, const Topic& topic, Seen& seen, BlockMaker& blocks) {
  if (frame.size > 0 && frame.size + BlockMaker::kMaxBlock > kMaxFrame) {
    if (!next_) next_ = topic;
    behind_ = true;
    return;
  }
  if (seen.from != 0 && blocks.is_too_old(topic, seen.from)) restart(seen, topic, NoticeKind::too_old);
  const SharedBlock block = blocks.block(topic, seen.from, seen.is_snapshot);
  if (block == nullptr) {
    seen.from = frame.head;
    return;
  }
  seen.from = block->to;
  seen.is_snapshot = block->is_snapshot && block->more;
  behind_ = behind_ || block->more;
  frame.size += block->size;
  frame.blocks.push_back(block);
}

/// Messages come after the rows: messages may be left out, rows may not.
void ClientFeed::fill_messages(Frame& frame, const MessageLane& lane) {
  const auto at = topics_.find({TopicKind::messages, {}, {}});
  if (at == topics_.end()) return;
  const std::size_t room = kMaxFrame - std::min(kMaxFrame, frame.size);
  MessageLane::Taken taken = lane.take(at->second.from, std::min(kMaxMessages, room));
  at->second.from = lane.head();
  frame.size += taken.size;
  frame.messages = std::move(taken.messages);
  frame.left_out = taken.left_out + std::exchange(left_out_, 0);
}

void ClientFeed::restart(Seen& seen, const Topic& topic, NoticeKind kind) {
  seen = {};
  notices_.push_back({kind, topic});
}

/// A snapshot under way does not count: else a large one would restart again and again.
void ClientFeed::drop_if_full(BlockMaker& blocks, Now now) {
  if (now.mono - looked_at_ < kQuiet) return;
  looked_at_ = now.mono;
  std::size_t size = waiting_->size;
  for (const auto& [topic, seen] : topics_) {
    if (topic.kind == TopicKind::messages || seen.is_snapshot || size > kMaxQueue) continue;
    size += blocks.waiting(topic, seen.from, kMaxQueue + 1 - size);
  }
  if (size <= kMaxQueue) return;
  notices_ = std::move(waiting_->notices);
  left_out_ = waiting_->left_out + waiting_->messages.size();
  waiting_.reset();
  for (auto& [topic, seen] : topics_) {
    if (topic.kind != TopicKind::messages) restart(seen, topic, NoticeKind::dropped);
  }
}

}  // namespace trb::gateway
