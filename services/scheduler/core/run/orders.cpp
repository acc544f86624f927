#include "services/scheduler/core/run/orders.hpp"

#include <algorithm>
#include <iterator>

namespace trb::scheduler {
namespace {

bool names(const PauseOrder& order, const std::string& task) {
  return std::ranges::find(order.doubles, task) != order.doubles.end();
}

}  // namespace

bool Orders::is_newer(const PauseOrder& order) const {
  if (!order.paused && !names_doubles(order)) return false;
  if (!pause_ || order.number != pause_->number) return !pause_ || order.number > pause_->number;
  return order.paused && !pause_->paused;
}

void Orders::adopt(const SignedRecord& record, PauseOrder order) {
  pause_ = std::move(order);
  pause_record_ = record;
  if (pause_->paused) return;
  seen_doubles_.insert(pause_->doubles.begin(), pause_->doubles.end());
  std::erase_if(doubles_, [&](const std::string& task) { return seen_doubles_.contains(task); });
}

bool Orders::names_doubles(const PauseOrder& order) const {
  if (!is_held_for_doubles()) return true;
  return std::ranges::all_of(pause_->doubles, [&](const std::string& task) { return names(order, task); });
}

void Orders::outbid(const PauseOrder& order) {
  if (!order.paused && !names_doubles(order)) outbid_ = std::max(outbid_, order.number);
}

std::uint32_t Orders::next_hold(std::uint32_t known) const {
  return std::min(std::max(known, outbid_) + 1, kMaxPauses);
}

void Orders::note_double(const std::string& task) {
  if (!seen_doubles_.contains(task)) doubles_.push_back(task);
}

std::vector<std::string> Orders::doubles() const {
  std::vector<std::string> out = doubles_;
  if (!is_held_for_doubles()) return out;
  const auto is_new = [&](const std::string& task) { return std::ranges::find(doubles_, task) == doubles_.end(); };
  std::ranges::copy_if(pause_->doubles, std::back_inserter(out), is_new);
  return out;
}

bool Orders::is_double(const std::string& task) const {
  const bool known = std::ranges::find(doubles_, task) != doubles_.end();
  return known || (is_held_for_doubles() && names(*pause_, task));
}

bool Orders::has_new_double() const {
  return std::ranges::any_of(doubles_, [&](const std::string& task) { return !is_held() || !names(*pause_, task); });
}

std::vector<SignedRecord> Orders::records() const {
  std::vector<SignedRecord> out;
  if (pause_) out.push_back(pause_record_);
  if (abort_) out.push_back(*abort_);
  return out;
}

}  // namespace trb::scheduler
