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
constexpr std::size_t kMostGrowthCounted = 512;  ///< ids and predecessors no longer differ from task to task

std::size_t most_growth(bool counts_on) {
  return counts_on ? kMostGrowthCounted : kMostGrowth;
}

/// The id with the number at its end counted on: "t9", "t10"; "t09", "t10". Empty: it ends in no number.
std::string counted_on(std::string id) {
  std::size_t at = id.size();
  while (at > 0 && id[at - 1] == '9') id[--at] = '0';
  if (at > 0 && id[at - 1] >= '0' && id[at - 1] < '9') {
    ++id[at - 1];
    return id;
  }
  return at < id.size() ? id.insert(at, 1, '1') : std::string();
}

/// Backwards is its own inverse.
void count_backwards(Task& task, std::size_t index) {
  for (std::uint16_t& before : task.after) before = static_cast<std::uint16_t>(index - before);
}

void count_on(std::vector<Task>& tasks) {
  std::string last;
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const std::string next = counted_on(last);
    last = tasks[i].id;
    if (last == next) tasks[i].id.clear();
    count_backwards(tasks[i], i);
  }
}

void count_again(std::vector<Task>& tasks) {
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    if (tasks[i].id.empty() && i > 0) tasks[i].id = counted_on(tasks[i - 1].id);
    count_backwards(tasks[i], i);
  }
}

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

std::optional<Blob> compact_start(const SignedRecord& start, bool counts_on) {
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
  if (counts_on) count_on(read->scenario.tasks);
  const Bytes bytes = encode(*read);
  Blob out{deflated(bytes)};
  if (bytes.size() > most_growth(counts_on) * out.bytes.size()) return std::nullopt;
  return out;
}

Result<RunStart> open_compact_start(const Blob& compact, bool counts_on) {
  const auto bytes = inflated(compact.bytes, std::min(kMostInflated, most_growth(counts_on) * compact.bytes.size()));
  if (!bytes) return bytes.error();
  auto start = decode<RunStart>(*bytes);
  if (start && counts_on) count_again(start->scenario.tasks);
  return start;
}

}  // namespace trb::scheduler
