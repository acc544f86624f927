// What is kept of a robot or a sensor over time, and which of it is wanted.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "common/base/time.hpp"

namespace trb::gateway {

enum class HistoryKind : std::uint8_t {
  node = 0,    ///< its node's state; detail: why it has expired
  connection,  ///< of the robot; detail: what is wrong
  fence,       ///< true: stopped
  control,     ///< who commands the robot; empty: nobody
  fault,       ///< about: the capability; detail: the severity
  fault_ended,
  out_of_use,  ///< about: the capability; detail: who said so
  in_use,
  task,     ///< about: RUN/TASK; detail: the skill
  value,    ///< about: its name
  reading,  ///< of a sensor; about: its unit; detail: its quality
};
constexpr auto enum_names(HistoryKind) {
  return std::array<std::string_view, 11>{"node",       "connection", "fence", "control", "fault",  "fault_ended",
                                          "out_of_use", "in_use",     "task",  "value",   "reading"};
}

struct HistoryEntry {
  UtcTime time;  ///< when the gateway received it: clocks of nodes may differ
  std::string node;
  std::string sensor;  ///< empty: of the robot
  HistoryKind kind{};
  std::string about;
  std::string value;  ///< JSON
  std::string detail;
  bool operator==(const HistoryEntry&) const = default;
};

/// The place of an entry in the order of a history.
struct HistoryPlace {
  std::int64_t time = std::numeric_limits<std::int64_t>::max();
  std::int64_t number = std::numeric_limits<std::int64_t>::max();
  bool operator==(const HistoryPlace&) const = default;
};

struct HistoryQuery {
  std::string node{};
  std::string sensor{};
  std::optional<HistoryKind> kind{};
  std::int64_t from = std::numeric_limits<std::int64_t>::min();  ///< UTC ns
  std::int64_t to = std::numeric_limits<std::int64_t>::max();
  HistoryPlace before{};  ///< of the last entry of the page before
  std::size_t most = 100;
};

/// The newest first.
struct HistoryPage {
  std::vector<HistoryEntry> entries;
  std::optional<HistoryPlace> next;  ///< there are more, before this
};

}  // namespace trb::gateway
