#include "services/scheduler/core/run/run_definition.hpp"

#include <algorithm>

#include "common/scenario/run_start.hpp"
#include "common/security/keys.hpp"
#include "proto/body.hpp"
#include "services/scheduler/core/run/compact_start.hpp"
#include "services/scheduler/core/run/members.hpp"

namespace trb::scheduler {
namespace {

const Member* find_member(const RunStart& start, const std::string& id) {
  const auto found =
      std::find_if(start.members.begin(), start.members.end(), [&](const Member& member) { return member.id == id; });
  return found == start.members.end() ? nullptr : &*found;
}

Result<RunStart> open_signed_start(const SignedRecord& record, Certificates& certificates) {
  const auto claimed = decode<RunStart>(record.payload.bytes);
  if (!claimed) return claimed.error();
  if (record.signer != claimed->submitter) {
    return fail(Errc::source_mismatch, "run_start signed by '" + record.signer + "', not by its submitter");
  }
  const Member* submitter = find_member(*claimed, record.signer);
  if (submitter == nullptr)
    return fail(Errc::not_permitted, "submitter '" + record.signer + "' is no member of the run");
  const auto certificate = open_member(*submitter, certificates);
  if (!certificate) return certificate.error();
  return open_record<RunStart>(record, kSignedRunStart, *certificate);
}

}  // namespace

const Blob* RunDefinition::compact(bool counts_on) const {
  auto& made = compact_.at(counts_on ? 1 : 0);
  if (!made) made = compact_start(record_, counts_on);
  return *made ? &**made : nullptr;
}

Result<RunDefinition> RunDefinition::open(const SignedRecord& record, Certificates& certificates) {
  auto start = open_signed_start(record, certificates);
  if (!start) return start.error();
  if (auto checked = check_run_start(*start); !checked) return checked.error();
  return RunDefinition(record, std::move(*start));
}

RunDefinition::RunDefinition(const SignedRecord& record, RunStart start)
    : record_(record),
      start_(std::move(start)),
      tag_(digest(start_.run + start_.digest.bytes).substr(0, kTagSize)),
      rule_(start_),
      successors_(successors_of(start_.scenario)) {
  for (std::size_t i = 0; i < tasks().size(); ++i) {
    const OnFailure then = tasks()[i].on_failure;
    index_.emplace(tasks()[i].id, static_cast<TaskIndex>(i));
    has_conditions_ = has_conditions_ || !tasks()[i].when.empty();
    skips_on_failure_ = skips_on_failure_ || then == OnFailure::skip || then == OnFailure::continue_;
    aborts_on_failure_ = aborts_on_failure_ || then == OnFailure::abort;
  }
}

std::optional<TaskIndex> RunDefinition::index_of(const std::string& task) const {
  const auto found = index_.find(task);
  if (found == index_.end()) return std::nullopt;
  return found->second;
}

bool RunDefinition::ends_run(TaskIndex task, const TaskResult& result) const {
  return tasks()[task].on_failure == OnFailure::abort &&
         (result.outcome == TaskOutcome::failed || result.outcome == TaskOutcome::interrupted);
}

std::optional<UtcTime> RunDefinition::next_end(UtcTime steady) const {
  if (!expired(steady)) return UtcTime{start_.expires};
  if (steady < buried_until()) return buried_until();
  return std::nullopt;
}

}  // namespace trb::scheduler
