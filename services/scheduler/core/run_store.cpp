#include "services/scheduler/core/run_store.hpp"

#include <algorithm>
#include <tuple>

namespace trb::scheduler {
namespace {

const std::string& run_in(const TaskResult& result) {
  return result.key.run;
}

template <class Inside>
const std::string& run_in(const Inside& body) {
  return body.run;
}

}  // namespace

template <class Fact>
Status RunStore::apply_to(const std::string& run, const Fact& fact) {
  Run* known = find(run);
  if (known != nullptr) return known->apply(fact);
  return fail(Errc::conflict, "a " + std::string(Fact::kSubtype) + " of run '" + run + "', which has no journal_run");
}

Status RunStore::apply_start(const JournalRun& fact) {
  auto run = open(fact.start);
  if (!run) return run.error();
  Run* known = find((*run)->id());
  return (known != nullptr ? *known : add(std::move(*run))).apply(fact);
}

template <class Inside, class Fact>
Status RunStore::apply_signed(const SignedRecord& record, const Fact& fact) {
  const auto inside = decode<Inside>(record.payload.bytes);
  return inside ? apply_to(run_in(*inside), fact) : Status(inside.error());
}

Status RunStore::apply(const Body& fact) {
  return visit(Overloaded{
                   [&](const JournalRun& is) { return apply_start(is); },
                   [&](const JournalStart& is) { return apply_to(is.key.run, is); },
                   [&](const JournalResult& is) { return apply_signed<TaskResult>(is.result, is); },
                   [&](const JournalChoice& is) { return apply_signed<Choice>(is.choice, is); },
                   [&](const JournalDelivered& is) { return apply_to(is.run, is); },
                   [&](const JournalAbort& is) { return apply_signed<AbortOrder>(is.order, is); },
                   [&](const JournalDecision& is) { return apply_signed<Decision>(is.decision, is); },
                   [&](const JournalPause& is) { return apply_signed<PauseOrder>(is.order, is); },
                   [&](const JournalEnd& is) { return apply_signed<RunEnd>(is.end, is); },
                   [](const auto& other) -> Status {
                     return fail(Errc::bad_value,
                                 "'" + std::string(subtype_of(Body(other))) + "' is no journal record");
                   },
               },
               fact);
}

Run& RunStore::add(std::unique_ptr<Run> run) {
  const std::string id = run->id();
  Run& added = *runs_.emplace(id, std::move(run)).first->second;
  const auto age = [](const Run* one) { return std::tie(one->definition().start().created, one->id()); };
  const auto place = std::lower_bound(by_age_.begin(), by_age_.end(), &added,
                                      [&](const Run* a, const Run* b) { return age(a) < age(b); });
  by_age_.insert(place, &added);
  return added;
}

Run* RunStore::find(const std::string& run) const {
  const auto found = runs_.find(run);
  return found == runs_.end() ? nullptr : found->second.get();
}

void RunStore::remove(const std::string& run) {
  std::erase_if(by_age_, [&](const Run* one) { return one->id() == run; });
  runs_.erase(run);
}

}  // namespace trb::scheduler
