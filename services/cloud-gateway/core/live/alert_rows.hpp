// Rows of the alerts that this node's resilience reports.
#pragma once

#include <set>
#include <string>

#include "common/actor/outbox.hpp"
#include "services/cloud-gateway/core/live/row_book.hpp"

namespace trb::gateway {

class AlertRows {
 public:
  static constexpr std::size_t kMaxAlerts = 256;

  explicit AlertRows(RowBook& book) : book_(book) {}

  /// The whole table: alerts missing in it are removed.
  void take(const AlertTable& table, Now now, Outbox& out);
  void on_silence(Now now);

 private:
  RowBook& book_;
  std::set<std::string> alerts_;
};

}  // namespace trb::gateway
