#include "common/security/rights.hpp"

#include <algorithm>
#include <array>

#include "common/security/services.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

struct SigningRight {
  std::string_view purpose;
  bool robot;
  bool cloud;
  std::array<std::string_view, 4> makers;  ///< services that may ask for it; "probe": the command line
};

// Where no service may ask, only the router signs for itself, the node's own `trb fleet request`, or the authority.
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
    {kSignedAuditHead, false, true, {"cloud-gateway"}},
    {kSignedRequest, false, false, {}},
    {kSignedCertificate, false, false, {}},
    {kSignedRevocations, false, false, {}},
    {kSignedInvitation, false, false, {}},
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

std::string subtypes_of(Scope scope, bool robot, bool cloud) {
  std::string out;
  for (const auto& [subtype, travel] : travel_rows()) {
    if (travel.scope == scope && travel.robot == robot && travel.cloud == cloud) {
      out += (out.empty() ? "" : " ") + std::string(subtype);
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

bool may_cross(Role role, std::string_view subtype) {
  const Travel* travel = find_travel(subtype);
  return travel == nullptr || allows(role, travel->robot, travel->cloud);
}

bool may_send_out(Role role, std::string_view subtype) {
  const Travel* travel = find_travel(subtype);
  return may_cross(role, subtype) && (travel == nullptr || travel->scope == Scope::fleet);
}

// Only these services on the bus can command the robot past the control lease, report an outcome that the robot has not
// had, or take a task from it.
bool may_send_on_bus(std::string_view service, bool probe, std::string_view subtype) {
  const Travel* travel = find_travel(subtype);
  if (travel == nullptr) return true;
  const std::string_view saying = probe ? kProbe : service;
  const Senders& senders = travel->senders;
  if (senders.front().empty()) return travel->scope == Scope::fleet;
  return std::ranges::any_of(
      senders, [&](std::string_view one) { return one == kAnyService || (!one.empty() && one == saying); });
}

std::string visitor_of(std::string_view service) {
  return std::string(service) + ".doctor";
}

bool may_visitor_send(std::string_view subtype) {
  return subtype == ServiceListRequest::kSubtype || subtype == ServiceAlive::kSubtype;
}

bool may_take(std::string_view service, std::string_view subtype) {
  return is_reserved_service(service) || !is_reserved(subtype);
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
  constexpr std::pair<Scope, std::string_view> kScopes[] = {{Scope::fleet, "from node to node"},
                                                            {Scope::link, "between the routers of a link"},
                                                            {Scope::bus, "on one node's own bus"},
                                                            {Scope::record, "never as a message"}};
  std::string out = "| Goes | from a robot's node | from the cloud | Subtypes |\n|---|---|---|---|\n";
  for (const auto& [scope, name] : kScopes) {
    for (const auto& [robot, cloud] : {std::pair{true, true}, {true, false}, {false, true}, {false, false}}) {
      const std::string words = subtypes_of(scope, robot, cloud);
      if (!words.empty()) out += row_of(name, robot, cloud, words);
    }
  }
  out += row_of("from node to node", true, true, "a user's own words: command, request, information");
  out += "\n| On a node's own bus | only of |\n|---|---|\n";
  for (const auto& [subtype, travel] : travel_rows()) {
    for (const std::string_view sender : travel.senders) {
      if (sender.empty()) continue;
      out += "| " + std::string(subtype) + " | " +
             std::string(sender == kAnyService ? "any service or probe" : sender) + " |\n";
    }
  }
  out += "\n| Signed record | a robot's node signs it | the cloud signs it | for |\n|---|---|---|---|\n";
  for (const SigningRight& row : kSignatures) out += row_of(row.purpose, row.robot, row.cloud, makers_of(row));
  return out;
}

}  // namespace trb
