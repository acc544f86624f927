#include "services/scheduler/core/run/compact_start.hpp"

#include <algorithm>
#include <utility>

#include "common/base/deflate.hpp"
#include "common/scenario/run_start.hpp"
#include "proto/body.hpp"

namespace trb::scheduler {
namespace {

constexpr std::size_t kMostInflated = 1U << 19U;  ///< the largest payload of a SignedRecord
/// Starts become 4 to 12 times as long. What a member sends is to cost its reader no more than its bytes say.
constexpr std::size_t kMostGrowth = 32;

RunStart rebuilt(RunStart from) {
  return build_run_start(std::move(from.scenario), std::move(from.members), std::move(from.submitter), {from.created},
                         {from.expires}, std::move(from.run), std::move(from.first.robots), from.priority);
}

}  // namespace

void KnownCertificates::learn(const RouteTable& table) {
  by_node_.clear();
  for (const Route& route : table.routes) by_node_[route.id] = route.certificate;
}

std::optional<RunStart> KnownCertificates::complete(RunStart start) const {
  for (Member& member : start.members) {
    const auto known = by_node_.find(member.id);
    if (known == by_node_.end()) return std::nullopt;
    member.certificate = known->second;
  }
  return rebuilt(std::move(start));
}

std::optional<Blob> compact_start(const SignedRecord& start) {
  auto read = decode<RunStart>(start.payload.bytes);
  if (!read) return std::nullopt;
  // The tasks may name their robots themselves.
  std::vector<std::string> robots = std::exchange(read->first.robots, {});
  if (encode(rebuilt(*read)) != start.payload.bytes) {
    read->first.robots = std::move(robots);
    if (encode(rebuilt(*read)) != start.payload.bytes) return std::nullopt;
  }
  for (Member& member : read->members) member.certificate = {};
  read->digest = {};
  read->electorate.clear();
  const Bytes bytes = encode(*read);
  Blob out{deflated(bytes)};
  if (bytes.size() > kMostGrowth * out.bytes.size()) return std::nullopt;
  return out;
}

Result<RunStart> open_compact_start(const Blob& compact) {
  const auto bytes = inflated(compact.bytes, std::min(kMostInflated, kMostGrowth * compact.bytes.size()));
  if (!bytes) return bytes.error();
  return decode<RunStart>(*bytes);
}

}  // namespace trb::scheduler
