#include "services/cloud-gateway/core/live/alert_rows.hpp"

#include <utility>

#include "common/base/hex.hpp"
#include "common/security/keys.hpp"

namespace trb::gateway {
namespace {

constexpr std::size_t kIdBytes = 8;

/// The same for as long as the fault is listed.
std::string id_of(const Alert& lesser) {
  const std::string what = source_of(lesser) + '\n' + std::string(name_of(lesser.severity)) + '\n';
  return to_hex(digest(what + std::to_string(lesser.time)).substr(0, kIdBytes));
}

}  // namespace

void AlertRows::take(const AlertTable& table, Now now, Outbox& out) {
  std::set<std::string> before = std::exchange(alerts_, {});
  lesser_.clear();
  std::vector<Alert> taken, known;
  for (const Alert& told : table.alerts) {
    Alert alert = told;
    if (told.id.empty()) alert.id = id_of(told);
    if (alerts_.contains(alert.id)) continue;
    if (alerts_.size() == kMaxAlerts) {
      out.count("refused.too_many_alerts");
      continue;
    }
    alerts_.insert(alert.id);
    before.erase(alert.id);
    if (told.id.empty()) lesser_.insert(alert.id);
    if (!told.id.empty()) known.push_back(alert);
    taken.push_back(std::move(alert));
  }
  desk_.see(known, now.utc);
  for (Alert& alert : taken) {
    const RowKey key{RowKind::alert, {}, alert.id};
    Alarm alarm = alarm_of(alert);
    book_.put(key, AlertRow{std::move(alert), std::move(alarm)}, Live::live, now);
  }
  for (const std::string& gone : before) book_.remove({RowKind::alert, {}, gone}, now);
}

Alarm AlertRows::alarm_of(const Alert& alert) const {
  if (!lesser_.contains(alert.id)) return desk_.of(alert.id);
  Alarm out;
  out.priority = priority_of(alert.severity);
  out.source = source_of(alert);
  return out;
}

void AlertRows::refresh(Now now) {
  for (const std::string& id : alerts_) {
    const Row* row = book_.find({RowKind::alert, {}, id});
    const auto* shown = row == nullptr ? nullptr : std::get_if<AlertRow>(&row->content);
    if (shown == nullptr) continue;
    AlertRow changed{shown->alert, alarm_of(shown->alert)};
    if (changed.alarm != shown->alarm) book_.put(row->key, std::move(changed), row->live, now);
  }
}

void AlertRows::on_silence(Now now) {
  for (const std::string& alert : alerts_) book_.set_live({RowKind::alert, {}, alert}, Live::not_heard, now);
}

}  // namespace trb::gateway
