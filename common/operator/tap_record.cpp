#include "common/operator/tap_record.hpp"

#include "proto/phase.hpp"

namespace trb::op {
namespace {

bool passes(const TapFilter& filter, const HeaderView& header) {
  if (filter.subtype) return header.subtype == *filter.subtype;
  return filter.all || phase_of(header.subtype) != CostPhase::upkeep;
}

}  // namespace

std::optional<TapRecord> read_tap(BytesView direction, BytesView frame, const TapFilter& filter, UtcTime now) {
  const auto header = decode_frame(frame);
  if (!header || direction.size() != 1 || !passes(filter, *header)) return std::nullopt;
  return TapRecord{direction[0], now, *header};
}

std::string to_json(const TapRecord& record) {
  std::string out = R"({"direction":")";
  out += record.direction;
  out += R"(","time":")" + to_iso8601(record.time) + "\",";
  return out + message_to_json(to_message(record.header)).substr(1);
}

}  // namespace trb::op
