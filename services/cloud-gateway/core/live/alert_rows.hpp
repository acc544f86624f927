// Rows of the alerts that this node's resilience reports. A robot's WARNING or URGENT fault comes without an id,
// because nobody decides on it: it gets one here, and is no alarm to the desk, so that it makes no later CRITICAL one
// chatter.
#pragma once

#include <set>
#include <string>

#include "common/actor/outbox.hpp"
#include "services/cloud-gateway/core/alarms/alarm_desk.hpp"
#include "services/cloud-gateway/core/live/row_book.hpp"

namespace trb::gateway {

class AlertRows {
 public:
  static constexpr std::size_t kMaxAlerts = 256;

  /// The desk knows what people did with them; it must outlive this.
  AlertRows(RowBook& book, AlarmDesk& desk) : book_(book), desk_(desk) {}

  /// The whole table: alerts missing in it are removed.
  void take(const AlertTable& table, Now now, Outbox& out);
  /// Somebody has done something with an alarm, or its shelf has ended.
  void refresh(Now now);
  void on_silence(Now now);

 private:
  [[nodiscard]] Alarm alarm_of(const Alert& alert) const;

  RowBook& book_;
  AlarmDesk& desk_;
  std::set<std::string> alerts_;
  std::set<std::string> lesser_;  ///< those of `alerts_` that came without an id
};

}  // namespace trb::gateway
