// Run: orders to hold it, to let it go on, to abort it; and the word that it has FINISHED. Whoever knows an order owes
// it to every member: who gave it may be gone.
#include <algorithm>

#include "proto/body.hpp"
#include "services/scheduler/core/run.hpp"

namespace trb::scheduler {

Result<AbortOrder> Run::check_abort(const SignedRecord& record) const {
  const auto signer = members_.find(record.signer);
  if (signer == members_.end()) {
    return fail(Errc::not_permitted, "run " + id() + ": '" + record.signer + "' is no member");
  }
  auto order = open_record<AbortOrder>(record, kSignedRunAbort, signer->second);
  if (!order) return order;
  if (order->run != id()) return fail(Errc::conflict, "run " + id() + ": the order is for another run");
  if (order->by != record.signer) return fail(Errc::source_mismatch, "run " + id() + ": the order names another node");
  return order;
}

Status Run::apply(const JournalAbort& fact) {
  if (auto order = check_abort(fact.order); !order) return order.error();
  if (abort_) return Done{};
  abort_ = fact.order;
  ++version_;
  abort_signature.reset();
  deliveries.drop(DeliveryKind::baton);
  needs.clear();
  owe_to_members(DeliveryKind::abort);
  return Done{};
}

Result<PauseOrder> Run::check_pause(const SignedRecord& record) const {
  const auto signer = members_.find(record.signer);
  if (signer == members_.end()) {
    return fail(Errc::not_permitted, "run " + id() + ": '" + record.signer + "' is no member");
  }
  auto order = open_record<PauseOrder>(record, kSignedRunPause, signer->second);
  if (!order) return order;
  if (order->run != id()) return fail(Errc::conflict, "run " + id() + ": the order is for another run");
  if (order->by != record.signer) return fail(Errc::source_mismatch, "run " + id() + ": the order names another node");
  if (order->number == 0 || order->number > kMaxPauses + (order->paused ? 0 : 1)) {
    return fail(Errc::bad_value,
                "run " + id() + ": number " + std::to_string(order->number) + " is not one of 1 to " +
                    std::to_string(kMaxPauses),
                "who was held so often is aborted and begun anew");
  }
  return order;
}

bool Run::names_doubles(const PauseOrder& order) const {
  if (!held_for_doubles()) return true;
  return std::all_of(pause_->doubles.begin(), pause_->doubles.end(), [&](const std::string& task) {
    return std::find(order.doubles.begin(), order.doubles.end(), task) != order.doubles.end();
  });
}

void Run::outbid(const PauseOrder& order) {
  if (!order.paused && !names_doubles(order)) outbid_ = std::max(outbid_, order.number);
}

std::uint32_t Run::next_hold() const {
  const std::uint32_t known = pause_ ? pause_->number : 0;
  return std::min(std::max(known, outbid_) + 1, kMaxPauses);
}

bool Run::is_newer(const PauseOrder& order) const {
  if (!order.paused && !names_doubles(order)) return false;
  if (!pause_ || order.number != pause_->number) return !pause_ || order.number > pause_->number;
  return order.paused && !pause_->paused;
}

Status Run::apply(const JournalPause& fact) {
  auto order = check_pause(fact.order);
  if (!order) return order.error();
  if (!is_newer(*order)) return Done{};
  pause_ = std::move(*order);
  pause_record_ = fact.order;
  if (!pause_->paused) {
    seen_doubles_.insert(pause_->doubles.begin(), pause_->doubles.end());
    std::erase_if(doubles_, [&](const std::string& task) { return seen_doubles_.contains(task); });
  }
  ++version_;
  hold_signature.reset();
  deliveries.drop(DeliveryKind::pause);
  owe_to_members(DeliveryKind::pause);
  return Done{};
}

void Run::owe_to_members(DeliveryKind kind) {
  for (const std::string& member : member_ids_) {
    if (member != self_) deliveries.owe(kind, member, {});
  }
}

std::vector<SignedRecord> Run::orders() const {
  std::vector<SignedRecord> out;
  if (pause_) out.push_back(pause_record_);
  if (abort_) out.push_back(*abort_);
  return out;
}

bool Run::has_new_double() const {
  return std::any_of(doubles_.begin(), doubles_.end(), [&](const std::string& task) {
    return !held() || std::find(pause_->doubles.begin(), pause_->doubles.end(), task) == pause_->doubles.end();
  });
}

Result<RunEnd> Run::check_end(const SignedRecord& record) const {
  const std::string name = "run " + id() + ": its end: ";
  if (record.signer != judge()) {
    return fail(Errc::not_permitted, name + "'" + record.signer + "' does not say it, '" + judge() + "' does");
  }
  auto end = open_record<RunEnd>(record, kSignedRunEnd, members_.at(judge()));
  if (!end) return end;
  if (end->run != id() || end->digest != start_.digest) return fail(Errc::conflict, name + "of another run");
  if (end->by != record.signer) return fail(Errc::source_mismatch, name + "it names another node");
  if (end->state != RunState::finished) return fail(Errc::bad_value, name + "only FINISHED is said so");
  return end;
}

Status Run::apply(const JournalEnd& fact) {
  if (auto end = check_end(fact.end); !end) return end.error();
  if (end_) return Done{};
  end_ = fact.end;
  ++version_;
  end_signature.reset();
  needs.clear();
  for (const DeliveryKind kind :
       {DeliveryKind::baton, DeliveryKind::abort, DeliveryKind::decision, DeliveryKind::pause})
    deliveries.drop(kind);
  return Done{};
}

}  // namespace trb::scheduler
