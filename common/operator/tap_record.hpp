// A message that has passed a node's router, as its tap tells it.
#pragma once

#include <optional>
#include <string>

#include "common/base/time.hpp"
#include "proto/message.hpp"

namespace trb::op {

struct TapRecord {
  char direction = '=';  ///< '<' in, '>' out, '=' within the node
  UtcTime time;          ///< when the tap was read
  HeaderView header;     ///< of the frame, which must outlive it
};

struct TapFilter {
  std::optional<std::string> subtype{};  ///< this one alone
  bool all = false;                      ///< else without keep-alives, lists, proofs of delivery
};

/// Of the tap's two frames: the direction and the message. Nothing if it is none, or none that the filter lets through.
std::optional<TapRecord> read_tap(BytesView direction, BytesView frame, const TapFilter& filter, UtcTime now);

/// The message as JSON, and first which way it passed and when.
std::string to_json(const TapRecord& record);

}  // namespace trb::op
