#include "common/security/rights.hpp"

#include <algorithm>
#include <array>

#include "proto/body.hpp"

namespace trb {
namespace {

constexpr auto kSubtypes = [] {
  constexpr Road fleet = Road::fleet;
  constexpr Road link = Road::link;
  constexpr Road bus = Road::bus;
  constexpr Road record = Road::record;
  // A robot's node may start, follow and abort runs, stop and release robots: a fleet whose cloud is gone is still
  // worked. What only a robot can know, only its node says.
  std::array rows{
      SubtypeRight{"ack", fleet, true, true},
      SubtypeRight{"nack", fleet, true, true},
      SubtypeRight{"run_accepted", fleet, true, true},
      SubtypeRight{"stop", fleet, true, true},
      SubtypeRight{"release", fleet, true, true},
      SubtypeRight{"baton", fleet, true, true},
      SubtypeRight{"baton_journaled", fleet, true, true},
      SubtypeRight{"need_definition", fleet, true, true},
      SubtypeRight{"definition", fleet, true, true},
      SubtypeRight{"need_results", fleet, true, true},
      SubtypeRight{"results", fleet, true, true},
      SubtypeRight{"results_journaled", fleet, true, true},
      SubtypeRight{"run_abort", fleet, true, true},
      SubtypeRight{"abort_confirmed", fleet, true, true},
      SubtypeRight{"run_over", fleet, true, true},
      SubtypeRight{"need_end", fleet, true, true},
      SubtypeRight{"run_decision", fleet, false, true},
      SubtypeRight{"decision_journaled", fleet, true, true},
      SubtypeRight{"release_tasks", fleet, false, true},
      // A robot that is broken is put back by who stands at its node, or by the cloud: no other robot's keys do.
      SubtypeRight{"take_out_of_use", fleet, false, true},
      SubtypeRight{"take_into_use", fleet, false, true},
      SubtypeRight{"run_pause", fleet, true, true},
      SubtypeRight{"pause_journaled", fleet, true, true},
      SubtypeRight{"run_watch", fleet, true, true},
      SubtypeRight{"run_changed", fleet, true, true},
      SubtypeRight{"alert_list", fleet, true, true},
      SubtypeRight{"alert_table", fleet, true, true},
      SubtypeRight{"history_list", fleet, true, true},
      SubtypeRight{"history_table", fleet, true, true},
      SubtypeRight{"task_progress", fleet, true, true},
      SubtypeRight{"run_query", fleet, true, true},
      SubtypeRight{"run_view", fleet, true, true},
      SubtypeRight{"run_list", fleet, true, true},
      SubtypeRight{"run_table", fleet, true, true},
      SubtypeRight{"robot_fault", fleet, true, false},
      SubtypeRight{"robot_connection", fleet, true, false},
      SubtypeRight{"inject_fault", fleet, true, true},
      SubtypeRight{"robot_state", fleet, true, false},
      SubtypeRight{"sensor_read", fleet, true, true},
      SubtypeRight{"sensor_reading", fleet, true, true},
      SubtypeRight{"sensor_watch", fleet, true, true},
      SubtypeRight{"sensor_snapshot", fleet, true, true},
      SubtypeRight{"sensor_image", fleet, true, true},
      SubtypeRight{"sensor_list", fleet, true, true},
      SubtypeRight{"sensor_table", fleet, true, true},
      SubtypeRight{"route_list", fleet, true, true},
      SubtypeRight{"route_table", fleet, true, true},
      SubtypeRight{"service_list", fleet, true, true},
      SubtypeRight{"service_table", fleet, true, true},
      SubtypeRight{"router_counters", fleet, true, true},
      SubtypeRight{"adapter_counters", fleet, true, true},
      SubtypeRight{"counters", fleet, true, true},
      SubtypeRight{"link_troubles", fleet, true, true},
      SubtypeRight{"link_trouble_table", fleet, true, true},
      SubtypeRight{"echo_request", fleet, true, true},
      SubtypeRight{"echo", fleet, true, true},
      SubtypeRight{"hello", link, true, true},
      SubtypeRight{"keep_alive", link, true, true},
      SubtypeRight{"goodbye", link, true, true},
      SubtypeRight{"node_profile", link, true, true},
      SubtypeRight{"seal", link, true, true},
      SubtypeRight{"fleet_news", link, true, true},  // the authority has signed what is in it
      SubtypeRight{"neighbours", link, true, true},
      SubtypeRight{"relayed", link, true, true},
      SubtypeRight{"relay_refused", link, true, true},
      SubtypeRight{"node_sensors", bus, false, false},
      SubtypeRight{"service_hello", bus, false, false},
      SubtypeRight{"service_welcome", bus, false, false},
      SubtypeRight{"service_alive", bus, false, false},
      SubtypeRight{"service_alive_seen", bus, false, false},
      SubtypeRight{"hello_wanted", bus, false, false},
      SubtypeRight{"sign_request", bus, false, false},
      SubtypeRight{"signed_record", bus, false, false},
      SubtypeRight{"peer_joined", bus, false, false},
      SubtypeRight{"peer_expired", bus, false, false},
      SubtypeRight{"run_submit", bus, false, false},
      SubtypeRight{"alert_decide", bus, false, false},
      SubtypeRight{"execute", bus, false, false},
      SubtypeRight{"cancel_execution", bus, false, false},
      SubtypeRight{"execution_query", bus, false, false},
      SubtypeRight{"execution_state", bus, false, false},
      SubtypeRight{"outcome", bus, false, false},
      SubtypeRight{"outcome_journaled", bus, false, false},
      SubtypeRight{"adapter_state", bus, false, false},
      SubtypeRight{"adapter_state_request", bus, false, false},
      SubtypeRight{"bridge_command", bus, false, false},
      SubtypeRight{"bridge_event", bus, false, false},
      SubtypeRight{"bridge_state", bus, false, false},
      SubtypeRight{"beacon", record, false, false},
      SubtypeRight{"certificate", record, false, false},
      SubtypeRight{"certificate_request", record, false, false},
      SubtypeRight{"revocation_list", record, false, false},
      SubtypeRight{"sealed_range", record, false, false},
      SubtypeRight{"relayed_frame", record, false, false},
      SubtypeRight{"relay_alive", record, false, false},  // inside one
      SubtypeRight{"scenario", record, false, false},
      SubtypeRight{"run_start", record, false, false},
      SubtypeRight{"result", record, false, false},
      SubtypeRight{"abort_order", record, false, false},
      SubtypeRight{"decision", record, false, false},
      SubtypeRight{"pause_order", record, false, false},
      SubtypeRight{"run_end", record, false, false},
      SubtypeRight{"journal_end", record, false, false},
      SubtypeRight{"journal_archive", record, false, false},
      SubtypeRight{"journal_time", record, false, false},
      SubtypeRight{"journal_lost", record, false, false},
      SubtypeRight{"alert", record, false, false},
      SubtypeRight{"journal_decision", record, false, false},
      SubtypeRight{"journal_pause", record, false, false},
      SubtypeRight{"journal_run", record, false, false},
      SubtypeRight{"journal_start", record, false, false},
      SubtypeRight{"journal_result", record, false, false},
      SubtypeRight{"choice", record, false, false},
      SubtypeRight{"journal_choice", record, false, false},
      SubtypeRight{"journal_delivered", record, false, false},
      SubtypeRight{"journal_abort", record, false, false},
      SubtypeRight{"journal_tombstone", record, false, false},
  };
  std::ranges::sort(rows, {}, &SubtypeRight::subtype);
  return rows;
}();

constexpr std::string_view kProbe = "probe";

struct SigningRight {
  std::string_view purpose;
  bool robot;
  bool cloud;
  std::array<std::string_view, 4> makers;  ///< services that may ask for it; "probe": the command line
};

// Where nobody may ask, the router signs for itself, the node's own `trb fleet request`, or the authority.
constexpr SigningRight kSignatures[] = {
    {kSignedBeacon, true, true, {}},
    {kSignedSeal, true, true, {}},
    {kSignedRelayed, true, true, {}},
    // A cloud node's result: of a task that its own decision skips.
    {kSignedResult, true, true, {"scheduler"}},
    // And its choice: on a condition behind such a task.
    {kSignedChoice, true, true, {"scheduler"}},
    {kSignedRunStart, true, true, {kProbe, "cloud-gateway"}},
    {kSignedRunAbort, true, true, {kProbe, "cloud-gateway", "resilience", "scheduler"}},
    {kSignedRunPause, true, true, {kProbe, "cloud-gateway", "scheduler"}},
    {kSignedRunEnd, true, true, {"scheduler"}},
    {kSignedDecision, false, true, {"resilience"}},
    {kSignedRequest, false, false, {}},
    {kSignedCertificate, false, false, {}},
    {kSignedRevocations, false, false, {}},
};

// Also those that are still to come: an operator's service of today must not get their rights tomorrow.
constexpr std::string_view kReservedServices[] = {"router",    "mode-adapter", "ros-bridge",    "sensor-bus",
                                                  "scheduler", "resilience",   "cloud-gateway", "simulator",
                                                  "probe",     "tap"};

constexpr std::string_view kAnyService = "*";

struct BusRight {
  std::string_view subtype;
  std::string_view sayer;  ///< a service, "probe", or "*" for any of them
};

// What is no word from node to node and stands not here, the router alone says; a word from node to node that stands
// here, only these say. Nobody else on the bus can command the robot past the control lease, tell of an outcome that
// the robot has not had, or take a task from it.
constexpr BusRight kBusRights[] = {
    {"adapter_state", "mode-adapter"},
    {"adapter_state_request", "scheduler"},
    {"alert_decide", kProbe},
    {"alert_decide", "cloud-gateway"},
    {"bridge_command", "mode-adapter"},
    {"bridge_event", "ros-bridge"},
    {"bridge_state", "ros-bridge"},
    {"cancel_execution", "scheduler"},
    {"execute", "scheduler"},
    {"execution_query", "scheduler"},
    {"execution_state", "mode-adapter"},
    {"fleet_news", kProbe},
    {"node_profile", "mode-adapter"},
    {"need_end", "scheduler"},
    {"node_sensors", "sensor-bus"},
    {"outcome", "mode-adapter"},
    {"outcome_journaled", "scheduler"},
    {"release_tasks", "resilience"},
    {"run_decision", "resilience"},
    {"run_decision", "scheduler"},
    {"run_over", "scheduler"},
    {"run_submit", kProbe},
    {"run_submit", "cloud-gateway"},
    {"service_alive", kAnyService},
    {"service_hello", kAnyService},
    {"sign_request", kAnyService},
    {"take_into_use", kProbe},
    {"take_into_use", "cloud-gateway"},
    {"take_into_use", "resilience"},
    {"take_out_of_use", kProbe},
    {"take_out_of_use", "cloud-gateway"},
    {"take_out_of_use", "scheduler"},
};

const SigningRight* find_signature(std::string_view purpose) {
  const auto* at = std::find_if(std::begin(kSignatures), std::end(kSignatures),
                                [&](const SigningRight& row) { return row.purpose == purpose; });
  return at == std::end(kSignatures) ? nullptr : at;
}

bool allows(Role role, bool robot, bool cloud) {
  return role == Role::cloud ? cloud : robot;
}

std::string_view yes_no(bool value) {
  return value ? "yes" : "no";
}

std::string row_of(std::string_view what, bool robot, bool cloud, const std::string& words) {
  return "| " + std::string(what) + " | " + std::string(yes_no(robot)) + " | " + std::string(yes_no(cloud)) + " | " +
         words + " |\n";
}

std::string subtypes_of(Road road, bool robot, bool cloud) {
  std::string out;
  for (const SubtypeRight& row : kSubtypes) {
    if (row.road == road && row.robot == robot && row.cloud == cloud) {
      out += (out.empty() ? "" : " ") + std::string(row.subtype);
    }
  }
  return out;
}

std::string makers_of(const SigningRight& right) {
  std::string out;
  for (const std::string_view maker : right.makers) {
    if (!maker.empty()) out += (out.empty() ? "" : ", ") + std::string(maker);
  }
  if (!out.empty()) return out;
  return right.robot || right.cloud ? "the router, for itself" : "nobody on a bus";
}

}  // namespace

const SubtypeRight* find_right(std::string_view subtype) {
  const auto* at = std::ranges::lower_bound(kSubtypes, subtype, {}, &SubtypeRight::subtype);
  return at != kSubtypes.end() && at->subtype == subtype ? at : nullptr;
}

bool may_cross(Role role, std::string_view subtype) {
  const SubtypeRight* right = find_right(subtype);
  return right == nullptr ? !is_typed(subtype) : allows(role, right->robot, right->cloud);
}

bool may_send_out(Role role, std::string_view subtype) {
  const SubtypeRight* right = find_right(subtype);
  return may_cross(role, subtype) && (right == nullptr || right->road == Road::fleet);
}

bool may_say(std::string_view service, bool probe, std::string_view subtype) {
  const SubtypeRight* right = find_right(subtype);
  if (right == nullptr) return !is_typed(subtype);
  const std::string_view saying = probe ? kProbe : service;
  bool is_listed = false;
  for (const BusRight& row : kBusRights) {
    if (row.subtype != subtype) continue;
    if (row.sayer == kAnyService || row.sayer == saying) return true;
    is_listed = true;
  }
  return right->road == Road::fleet && !is_listed;
}

bool is_reserved_service(std::string_view name) {
  return std::find(std::begin(kReservedServices), std::end(kReservedServices), name) != std::end(kReservedServices);
}

bool may_take(std::string_view service, std::string_view subtype) {
  return is_reserved_service(service) || !is_typed(subtype);
}

bool may_sign(Role role, std::string_view purpose) {
  const SigningRight* right = find_signature(purpose);
  return right != nullptr && allows(role, right->robot, right->cloud);
}

bool may_have_signed(std::string_view service, bool probe, std::string_view purpose) {
  const SigningRight* right = find_signature(purpose);
  const std::string_view asking = probe ? kProbe : service;
  return right != nullptr && !asking.empty() &&
         std::find(right->makers.begin(), right->makers.end(), asking) != right->makers.end();
}

std::string rights_text() {
  constexpr std::pair<Road, std::string_view> kRoads[] = {{Road::fleet, "from node to node"},
                                                          {Road::link, "between the routers of a link"},
                                                          {Road::bus, "on one node's own bus"},
                                                          {Road::record, "never as a message"}};
  std::string out = "| Goes | from a robot's node | from the cloud | Subtypes |\n|---|---|---|---|\n";
  for (const auto& [road, name] : kRoads) {
    for (const auto& [robot, cloud] : {std::pair{true, true}, {true, false}, {false, true}, {false, false}}) {
      const std::string words = subtypes_of(road, robot, cloud);
      if (!words.empty()) out += row_of(name, robot, cloud, words);
    }
  }
  out += row_of("from node to node", true, true, "a user's own words: command, request, information");
  out += "\n| On a node's own bus | only of |\n|---|---|\n";
  for (const BusRight& row : kBusRights) {
    out += "| " + std::string(row.subtype) + " | " +
           std::string(row.sayer == kAnyService ? "any service or probe" : row.sayer) + " |\n";
  }
  out += "\n| Signed record | a robot's node signs it | the cloud signs it | for |\n|---|---|---|---|\n";
  for (const SigningRight& row : kSignatures) out += row_of(row.purpose, row.robot, row.cloud, makers_of(row));
  return out;
}

}  // namespace trb
