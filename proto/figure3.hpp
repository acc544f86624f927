// The datagram of the paper's Figure 3: a header of 32 bytes (type 4, subtype 8, sender 8, destination 8, data size 4;
// numbers big-endian, texts padded with zeros), then the data. For devices that speak the paper's format; the fleet's
// own wire (message.hpp) has no such limit on ids.
#pragma once

#include "proto/message.hpp"

namespace trb {

constexpr std::size_t kFigure3HeaderSize = 32;
constexpr std::size_t kFigure3WordSize = 8;

/// Errors: does_not_fit_figure_3, naming the field that is longer than 8 bytes or contains a zero.
Result<Bytes> to_figure3(const Message& message);

/// Errors: malformed (short, size differs from the data's length, bytes after a text's end), bad_value (type),
/// too_large.
Result<Message> from_figure3(BytesView datagram);

}  // namespace trb
