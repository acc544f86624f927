#include "common/drivers/lines/sender.hpp"

#include <algorithm>

#include "common/drivers/lines/frame.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxQueued = 64;
constexpr std::size_t kMaxQueuedBytes = 4U << 20U;
constexpr std::size_t kMaxUrgents = 64;
constexpr std::size_t kHeadFields = 4;

}  // namespace

FieldSender::FieldSender(const FieldChannel& settings, const FieldText& words) : settings_(settings), words_(words) {}

Status FieldSender::enqueue(Outgoing message, Now now, const DriverOut& out) {
  if (queue_.size() >= kMaxQueued || queued_bytes_ + message.data.size() > kMaxQueuedBytes) {
    return fail(Errc::queue_full, std::to_string(queue_.size()) + " messages wait for the robot already",
                "send slower, or look whether the robot still reads");
  }
  queued_bytes_ += message.data.size();
  queue_.push_back(std::move(message));
  pump(now, out);
  return Done{};
}

bool FieldSender::holds(Token token) const {
  return std::any_of(queue_.begin(), queue_.end(), [&](const Outgoing& message) { return message.token == token; });
}

bool FieldSender::remove(Token token) {
  const auto first = queue_.begin() + (field_ > 0 ? 1 : 0);
  const auto found = std::find_if(first, queue_.end(), [&](const Outgoing& message) { return message.token == token; });
  if (found == queue_.end()) return false;
  queued_bytes_ -= found->data.size();
  queue_.erase(found);
  return true;
}

void FieldSender::drop_all(const Error& why, const DriverOut& out) {
  for (const Outgoing& message : queue_) out.emit(Refused{message.token, why});
  queue_.clear();
  queued_bytes_ = 0;
  begin_next();
}

void FieldSender::drop_current(Token halted, const Error& why, const DriverOut& out) {
  if (field_ == 0 || queue_.empty()) return;
  if (queue_.front().token != halted) out.emit(Refused{queue_.front().token, why});
  queued_bytes_ -= queue_.front().data.size();
  queue_.pop_front();
  begin_next();
}

void FieldSender::begin_next() {
  field_ = offset_ = 0;
  waits_for_ok_ = false;
}

void FieldSender::urgent(Urgent urgent, Token ticket, Now now, const DriverOut& out) {
  // The answer to the last one confirms the earlier ones, so a storm of stops needs no more lines than this.
  if (urgents_.size() >= kMaxUrgents && urgents_.back().urgent == urgent) {
    urgents_.back().ticket = ticket;
    return;
  }
  if (urgents_.size() >= kMaxUrgents) drop_unwritten(urgent);
  urgents_.push_back({urgent, ticket, false, now.mono + seconds(settings_.ack_timeout_s)});
  pump(now, out);
}

/// The robot is to end as the next order says. Of the stops before a release one stays: it ends what moves.
void FieldSender::drop_unwritten(Urgent next) {
  const auto first = std::ranges::find(urgents_, false, &UrgentOrder::written);
  std::optional<UrgentOrder> stop;
  for (auto at = first; next == Urgent::release && at != urgents_.end(); ++at) {
    if (at->urgent == Urgent::stop) stop = *at;
  }
  urgents_.erase(first, urgents_.end());
  if (stop) urgents_.push_back(*stop);
}

void FieldSender::on_ok(Now now, const DriverOut& out) {
  if (!urgents_.empty()) return;
  if (!waits_for_ok_) {
    out.out.count("refused.stray_ok");
    return;
  }
  waits_for_ok_ = false;
  if (whole()) finish_current(out);
  pump(now, out);
}

std::optional<Token> FieldSender::on_urgent_done(Urgent urgent, Now now, const DriverOut& out) {
  if (urgents_.empty() || !urgents_.front().written || urgents_.front().urgent != urgent) {
    out.out.count("refused.stray_confirmation");
    return std::nullopt;
  }
  const Token ticket = urgents_.front().ticket;
  urgents_.pop_front();
  if (urgent == Urgent::stop) {
    out.out.count("from_robot.stopped");
    out.emit(Stopped{ticket});
  } else {
    out.out.count("from_robot.released");
    out.emit(Released{ticket});
  }
  pump(now, out);
  return ticket;
}

bool FieldSender::urgent_waits() const {
  return std::any_of(urgents_.begin(), urgents_.end(), [](const UrgentOrder& order) { return !order.written; });
}

bool FieldSender::may_begin(Now now) const {
  return !queue_.empty() && urgents_.empty() && !waits_for_ok_ && slot_free(now);
}

bool FieldSender::whole() const {
  const Outgoing& message = queue_.front();
  // A pause after nothing is not a field: with `delay` empty data ends with its size.
  const std::size_t least = delayed() && message.data.empty() ? kHeadFields : kHeadFields + 1;
  return field_ >= least && offset_ == message.data.size();
}

void FieldSender::pump(Now now, const DriverOut& out) {
  Bytes bytes;
  write_urgents(bytes, now, out);
  while (may_begin(now)) write_field(bytes, now, out);
  if (!bytes.empty()) out.robot.write(Channel::field, std::move(bytes));
}

void FieldSender::write_urgents(Bytes& bytes, Now now, const DriverOut& out) {
  for (UrgentOrder& order : urgents_) {
    if (order.written || !slot_free(now)) continue;
    append_field(bytes, words_.order(order.urgent), settings_.framing);
    out.out.count(order.urgent == Urgent::stop ? "to_robot.stop" : "to_robot.release");
    order.written = true;
    order.deadline = now.mono + seconds(settings_.ack_timeout_s);
    slot_ = now.mono + seconds(settings_.delay_s);
  }
}

void FieldSender::write_field(Bytes& bytes, Now now, const DriverOut& out) {
  const Outgoing& message = queue_.front();
  if (field_ < kHeadFields) {
    append_field(bytes, message.head[field_], settings_.framing);
  } else {
    const std::size_t end = chunk_end(message.data, offset_, settings_);
    append_field(bytes, BytesView(message.data).substr(offset_, end - offset_), settings_.framing);
    offset_ = end;
  }
  ++field_;
  out.out.count("to_robot." + message.subtype);
  slot_ = now.mono + seconds(settings_.delay_s);
  if (acknowledged()) {
    waits_for_ok_ = true;
    ok_deadline_ = now.mono + seconds(settings_.ack_timeout_s);
  } else if (whole()) {
    finish_current(out);
  }
}

void FieldSender::finish_current(const DriverOut& out) {
  out.emit(HandedOver{queue_.front().token});
  queued_bytes_ -= queue_.front().data.size();
  queue_.pop_front();
  begin_next();
}

bool FieldSender::tick(Now now, const DriverOut& out) {
  if (waits_for_ok_ && urgents_.empty() && now.mono >= ok_deadline_) return false;
  while (!urgents_.empty() && urgents_.front().written && now.mono >= urgents_.front().deadline) {
    if (acknowledged()) return false;
    urgents_.pop_front();  // a robot that cannot acknowledge may be unable to confirm, too
  }
  pump(now, out);
  return true;
}

std::optional<MonotonicTime> FieldSender::next_deadline() const {
  std::optional<MonotonicTime> next;
  if (urgents_.empty() && waits_for_ok_) next = ok_deadline_;
  if (!urgents_.empty() && urgents_.front().written) next = urgents_.front().deadline;
  const bool waits_for_slot = delayed() && (urgent_waits() || (urgents_.empty() && !queue_.empty()));
  return waits_for_slot ? earlier(next, slot_) : next;
}

void FieldSender::restart() {
  begin_next();
  urgents_.clear();
  slot_ = {};
}

}  // namespace trb::drivers
