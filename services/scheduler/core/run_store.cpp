#include "services/scheduler/core/run_store.hpp"

#include <algorithm>
#include <tuple>

namespace trb::scheduler {

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

Status RunStore::apply(const Body& fact) {
  return visit(Overloaded{
                   [&](const JournalRun& is) { return apply_start(is); },
                   [&](const JournalStart& is) { return apply_to(is.key.run, is); },
                   [&](const JournalResult& is) -> Status {
                     const auto result = decode<TaskResult>(is.result.payload.bytes);
                     return result ? apply_to(result->key.run, is) : Status(result.error());
                   },
                   [&](const JournalChoice& is) -> Status {
                     const auto choice = decode<Choice>(is.choice.payload.bytes);
                     return choice ? apply_to(choice->run, is) : Status(choice.error());
                   },
                   [&](const JournalDelivered& is) { return apply_to(is.run, is); },
                   [&](const JournalAbort& is) -> Status {
                     const auto order = decode<AbortOrder>(is.order.payload.bytes);
                     return order ? apply_to(order->run, is) : Status(order.error());
                   },
                   [&](const JournalDecision& is) -> Status {
                     const auto decision = decode<Decision>(is.decision.payload.bytes);
                     return decision ? apply_to(decision->run, is) : Status(decision.error());
                   },
                   [&](const JournalPause& is) -> Status {
                     const auto order = decode<PauseOrder>(is.order.payload.bytes);
                     return order ? apply_to(order->run, is) : Status(order.error());
                   },
                   [&](const JournalEnd& is) -> Status {
                     const auto end = decode<RunEnd>(is.end.payload.bytes);
                     return end ? apply_to(end->run, is) : Status(end.error());
                   },
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
