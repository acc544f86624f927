#include "services/cloud-gateway/core/live/alert_rows.hpp"

#include <utility>

namespace trb::gateway {

void AlertRows::take(const AlertTable& table, Now now, Outbox& out) {
  std::set<std::string> before = std::exchange(alerts_, {});
  for (const Alert& alert : table.alerts) {
    if (alert.id.empty() || alerts_.size() == kMaxAlerts) {
      out.count(alert.id.empty() ? "dropped.no_id" : "refused.too_many_alerts");
      continue;
    }
    alerts_.insert(alert.id);
    before.erase(alert.id);
    book_.put({RowKind::alert, {}, alert.id}, alert, Live::live, now);
  }
  for (const std::string& gone : before) book_.remove({RowKind::alert, {}, gone}, now);
}

void AlertRows::on_silence(Now now) {
  for (const std::string& alert : alerts_) book_.set_live({RowKind::alert, {}, alert}, Live::not_heard, now);
}

}  // namespace trb::gateway
