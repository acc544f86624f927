// How far a body may go, and who sends it: declared once, beside its subtype. The rights of nodes and services, the
// tables in the documents, and the counts of Equation 12 are made from it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "proto/phase.hpp"

namespace trb {

enum class Scope : unsigned char {
  fleet = 0,  ///< from node to node
  link,       ///< between the routers of a link
  bus,        ///< on one node's own bus
  record,     ///< never sent as a message: inside a signed record, a file or a datagram
};

inline constexpr std::string_view kProbe = "probe";  ///< the command line, on a bus
inline constexpr std::string_view kAnyService = "*";

/// Services that may send a body on their node's bus. Empty: any service, if it goes from node to node; otherwise only
/// the router.
using Senders = std::array<std::string_view, 4>;

struct Travel {
  Scope scope{};
  bool robot = false;  ///< a node of this role may send it over a link
  bool cloud = false;
  std::optional<CostPhase> phase;  ///< a record has none
  Senders senders{};
};

constexpr Travel between_nodes(CostPhase phase, Senders senders = {}) {
  return {Scope::fleet, true, true, phase, senders};
}
/// What only a robot's node can know.
constexpr Travel from_robots(CostPhase phase, Senders senders = {}) {
  return {Scope::fleet, true, false, phase, senders};
}
constexpr Travel from_cloud(CostPhase phase, Senders senders = {}) {
  return {Scope::fleet, false, true, phase, senders};
}
constexpr Travel between_routers(CostPhase phase, Senders senders = {}) {
  return {Scope::link, true, true, phase, senders};
}
constexpr Travel on_bus(CostPhase phase, Senders senders = {}) {
  return {Scope::bus, false, false, phase, senders};
}
constexpr Travel in_record(std::optional<CostPhase> phase = std::nullopt) {
  return {Scope::record, false, false, phase, {}};
}

struct TravelRow {
  std::string_view subtype;
  Travel travel;
};

/// A row for every reserved subtype, sorted by subtype.
std::span<const TravelRow> travel_rows();

/// The subtypes of each phase, as Markdown.
std::string phases_text();

/// For a reserved subtype; otherwise nullptr.
const Travel* find_travel(std::string_view subtype);

/// True for the subtypes of the middleware: those with a body, and the kinds of records that a service keeps. A user
/// may send none of them, and none reaches a robot as fields.
inline bool is_reserved(std::string_view subtype) {
  return find_travel(subtype) != nullptr;
}

}  // namespace trb
