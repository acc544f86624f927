// A message that has passed a node's router, as its tap reports it.
#pragma once

#include <optional>
#include <string>

#include "common/base/time.hpp"
#include "proto/message.hpp"

namespace trb::op {

struct TapRecord {
  char direction = '=';  ///< '<' in, '>' out, '=' within the node
  UtcTime time;          ///< when the tap was read
  HeaderView header;     ///< points into the frame, which must outlive it
};

struct TapFilter {
  std::optional<std::string> subtype{};  ///< only this one
  bool all = false;                      ///< false: without keep-alives, lists, proofs of delivery
};

/// From the tap's two frames: the direction and the message. Empty if malformed, or if the filter excludes it.
std::optional<TapRecord> read_tap(BytesView direction, BytesView frame, const TapFilter& filter, UtcTime now);

/// The message as JSON, preceded by its direction and time.
std::string to_json(const TapRecord& record);

}  // namespace trb::op
