#include "services/scheduler/core/run/compact_start.hpp"

#include "common/base/deflate.hpp"
#include "proto/body.hpp"

namespace trb::scheduler {
namespace {

constexpr std::size_t kMostInflated = 1U << 19U;  ///< the largest payload of a SignedRecord

}  // namespace

void KnownCertificates::learn(const RouteTable& table) {
  by_node_.clear();
  for (const Route& route : table.routes) by_node_[route.id] = route.certificate;
}

bool KnownCertificates::fill(RunStart& start) const {
  for (Member& member : start.members) {
    const auto known = by_node_.find(member.id);
    if (known == by_node_.end()) return false;
    member.certificate = known->second;
  }
  return true;
}

std::optional<Blob> compact_start(const SignedRecord& start) {
  auto read = decode<RunStart>(start.payload.bytes);
  if (!read || encode(*read) != start.payload.bytes) return std::nullopt;
  for (Member& member : read->members) member.certificate = {};
  return Blob{deflated(encode(*read))};
}

Result<RunStart> open_compact_start(const Blob& compact) {
  const auto bytes = inflated(compact.bytes, kMostInflated);
  if (!bytes) return bytes.error();
  return decode<RunStart>(*bytes);
}

}  // namespace trb::scheduler
