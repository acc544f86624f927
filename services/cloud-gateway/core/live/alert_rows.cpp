#include "services/cloud-gateway/core/live/alert_rows.hpp"

#include <utility>

namespace trb::gateway {

void AlertRows::take(const AlertTable& table, Now now, Outbox& out) {
  std::set<std::string> before = std::exchange(alerts_, {});
  std::vector<Alert> taken;
  for (const Alert& alert : table.alerts) {
    if (alert.id.empty() || alerts_.size() == kMaxAlerts) {
      out.count(alert.id.empty() ? "dropped.no_id" : "refused.too_many_alerts");
      continue;
    }
    alerts_.insert(alert.id);
    before.erase(alert.id);
    taken.push_back(alert);
  }
  desk_.see(taken, now.utc);
  for (Alert& alert : taken) {
    const RowKey key{RowKind::alert, {}, alert.id};
    Alarm alarm = desk_.of(alert.id);
    book_.put(key, AlertRow{std::move(alert), std::move(alarm)}, Live::live, now);
  }
  for (const std::string& gone : before) book_.remove({RowKind::alert, {}, gone}, now);
}

void AlertRows::refresh(Now now) {
  for (const std::string& id : alerts_) {
    const Row* row = book_.find({RowKind::alert, {}, id});
    const auto* shown = row == nullptr ? nullptr : std::get_if<AlertRow>(&row->content);
    if (shown == nullptr) continue;
    AlertRow changed{shown->alert, desk_.of(id)};
    if (changed.alarm != shown->alarm) book_.put(row->key, std::move(changed), row->live, now);
  }
}

void AlertRows::on_silence(Now now) {
  for (const std::string& alert : alerts_) book_.set_live({RowKind::alert, {}, alert}, Live::not_heard, now);
}

}  // namespace trb::gateway
