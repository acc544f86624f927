#include "proto/phase.hpp"

#include <algorithm>
#include <utility>

namespace trb {
namespace {

using Row = std::pair<std::string_view, Phase>;

constexpr auto kRows = [] {
  std::array rows{
      Row{"service_hello", Phase::boot},
      Row{"service_welcome", Phase::boot},
      Row{"run_submit", Phase::boot},
      Row{"beacon", Phase::identification},
      Row{"hello", Phase::identification},
      Row{"node_profile", Phase::devices},
      Row{"execute", Phase::task},
      Row{"outcome", Phase::task},
      Row{"results", Phase::task},
      Row{"adapter_state", Phase::task},
      Row{"baton", Phase::forward},
      Row{"definition", Phase::forward},
      Row{"need_definition", Phase::forward},
      Row{"need_results", Phase::forward},
      Row{"robot_fault", Phase::fail},
      Row{"robot_connection", Phase::fail},
      Row{"inject_fault", Phase::fail},
      Row{"robot_state", Phase::sensor},
      Row{"node_sensors", Phase::devices},
      Row{"sensor_read", Phase::sensor},
      Row{"sensor_reading", Phase::sensor},
      Row{"sensor_watch", Phase::sensor},
      Row{"sensor_snapshot", Phase::sensor},
      Row{"sensor_image", Phase::sensor},
      Row{"sensor_list", Phase::upkeep},
      Row{"sensor_table", Phase::upkeep},
      Row{"run_abort", Phase::fail},
      Row{"run_decision", Phase::fail},
      Row{"release_tasks", Phase::fail},
      Row{"run_pause", Phase::fail},
      Row{"take_out_of_use", Phase::fail},
      Row{"take_into_use", Phase::fail},
      Row{"run_over", Phase::upkeep},
      Row{"need_end", Phase::upkeep},
      Row{"decision_journaled", Phase::upkeep},
      Row{"pause_journaled", Phase::upkeep},
      Row{"run_watch", Phase::upkeep},
      Row{"run_changed", Phase::upkeep},
      Row{"alert_list", Phase::upkeep},
      Row{"alert_table", Phase::upkeep},
      Row{"alert_decide", Phase::upkeep},
      Row{"history_list", Phase::upkeep},
      Row{"history_table", Phase::upkeep},
      Row{"stop", Phase::fail},
      Row{"release", Phase::fail},
      Row{"ack", Phase::upkeep},
      Row{"nack", Phase::upkeep},
      Row{"service_alive", Phase::upkeep},
      Row{"service_alive_seen", Phase::upkeep},
      Row{"hello_wanted", Phase::upkeep},
      Row{"sign_request", Phase::upkeep},
      Row{"signed_record", Phase::upkeep},
      Row{"route_list", Phase::upkeep},
      Row{"route_table", Phase::upkeep},
      Row{"service_list", Phase::upkeep},
      Row{"service_table", Phase::upkeep},
      Row{"router_counters", Phase::upkeep},
      Row{"adapter_counters", Phase::upkeep},
      Row{"counters", Phase::upkeep},
      Row{"keep_alive", Phase::upkeep},
      Row{"goodbye", Phase::upkeep},
      Row{"seal", Phase::upkeep},
      Row{"fleet_news", Phase::upkeep},
      Row{"neighbours", Phase::identification},
      Row{"relay_alive", Phase::upkeep},
      Row{"relay_refused", Phase::upkeep},
      Row{"relayed", Phase::upkeep},
      Row{"link_troubles", Phase::upkeep},
      Row{"link_trouble_table", Phase::upkeep},
      Row{"echo_request", Phase::upkeep},
      Row{"echo", Phase::upkeep},
      Row{"peer_joined", Phase::upkeep},
      Row{"peer_expired", Phase::fail},
      Row{"cancel_execution", Phase::fail},
      Row{"execution_query", Phase::upkeep},
      Row{"execution_state", Phase::upkeep},
      Row{"outcome_journaled", Phase::upkeep},
      Row{"adapter_state_request", Phase::upkeep},
      // What goes to the robot is counted by the mode-adapter, on whichever road it goes on.
      Row{"bridge_command", Phase::upkeep},
      Row{"bridge_event", Phase::upkeep},
      Row{"bridge_state", Phase::upkeep},
      Row{"run_accepted", Phase::upkeep},
      Row{"baton_journaled", Phase::upkeep},
      Row{"results_journaled", Phase::upkeep},
      Row{"task_progress", Phase::upkeep},
      Row{"abort_confirmed", Phase::upkeep},
      Row{"run_query", Phase::upkeep},
      Row{"run_view", Phase::upkeep},
      Row{"run_list", Phase::upkeep},
      Row{"run_table", Phase::upkeep},
  };
  std::sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return a.first < b.first; });
  return rows;
}();

const Row* find(std::string_view subtype) {
  const auto* at = std::lower_bound(kRows.begin(), kRows.end(), subtype,
                                    [](const Row& row, std::string_view word) { return row.first < word; });
  return at != kRows.end() && at->first == subtype ? at : nullptr;
}

}  // namespace

bool has_phase(std::string_view subtype) {
  return find(subtype) != nullptr;
}

Phase phase_of(std::string_view subtype) {
  const Row* row = find(subtype);
  return row == nullptr ? Phase::task : row->second;
}

}  // namespace trb
