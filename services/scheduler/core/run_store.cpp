#include "services/scheduler/core/run_store.hpp"

#include <algorithm>
#include <tuple>

#include "services/scheduler/core/result_room.hpp"

namespace trb::scheduler {

template <class Fact>
Status RunStore::apply_to(const std::string& run, const Fact& fact) {
  Run* known = find(run);
  if (known != nullptr) return known->apply(fact);
  return fail(Errc::conflict, "a " + std::string(Fact::kKind) + " of run '" + run + "', which has no journal_run");
}

Status RunStore::apply_start(const JournalRun& fact) {
  auto run = open(fact.start);
  if (!run) return run.error();
  Run* known = find((*run)->id());
  return (known != nullptr ? *known : add(std::move(*run))).apply(fact);
}

Status RunStore::apply(const JournalRecord& fact) {
  if (const auto* start = std::get_if<JournalRun>(&fact)) return apply_start(*start);
  const auto run = run_of(fact);
  if (!run) return run.error();
  const auto apply_it = [&](const auto& is) -> Status {
    if constexpr (requires(Run & one) { one.apply(is); }) return apply_to(*run, is);
    return fail(Errc::bad_value, "'" + std::string(kind_of(fact)) + "' is no journal record");
  };
  return std::visit(apply_it, fact);
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

std::size_t RunStore::taken() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(by_age_, [](const Run* one) { return !one->orders().is_aborted(); }));
}

bool RunStore::has_place_for(const std::string& submitter) const {
  std::size_t open = 0;
  std::size_t aborted = 0;
  for (const Run* run : by_age_) {
    if (run->definition().start().submitter == submitter) ++(run->orders().is_aborted() ? aborted : open);
  }
  const auto share_of = [](std::size_t places) { return (places * 15 + 15) / 16; };
  const std::size_t left_by_others = kMaxRuns - std::min(taken() - open, kMaxRuns);
  return !full() && open < share_of(left_by_others) && aborted < share_of(kMaxRuns);
}

std::size_t RunStore::bytes_left(const std::string& node) const {
  std::size_t own = 0;
  std::size_t others = 0;
  for (const Run* run : by_age_) {
    const RunDefinition& definition = run->definition();
    (definition.start().submitter == node ? own : others) += definition.record().payload.bytes.size();
    const std::size_t signed_here = run->results().bytes_of(node);
    own += signed_here;
    others += run->results().bytes() - signed_here;
  }
  const std::size_t share = (most_bytes_ - std::min(others, most_bytes_)) / 4;
  return share - std::min(own, share);
}

Result<HeldResult> RunStore::received_result(const Run& run, const SignedRecord& record) const {
  auto held = run.received_result(record);
  if (!held) return held;
  const std::string& robot = held->result.robot;
  const std::size_t size = record.payload.bytes.size();
  // Its share is a sum over all runs: few results need it.
  if (run.results().bytes_of(robot) + size <= free_bytes(run, robot) || bytes_left(robot) >= size) return held;
  if (!run.results().grows_by(*run.index_of(held->result.key.task), *held)) return held;
  return fail(Errc::queue_full,
              "run " + run.id() + ": '" + robot + "' has its share of the " + std::to_string(most_bytes_ >> 20U) +
                  " MiB that open runs may take on '" + self_ + "'",
              "let its skills answer with less data, or abort runs that nobody needs: trb run list");
}

Run* RunStore::find(const std::string& run) const {
  const auto found = runs_.find(run);
  if (found == runs_.end()) return nullptr;
  found->second->next_visit().touch();
  return found->second.get();
}

const std::vector<Run*>& RunStore::touch_all() const {
  for (Run* run : by_age_) run->next_visit().touch();
  return by_age_;
}

std::vector<Run*> RunStore::due(Clock clock) const {
  std::vector<Run*> out;
  std::ranges::copy_if(by_age_, std::back_inserter(out),
                       [&](const Run* run) { return run->next_visit().is_due(clock.mono, clock.steady); });
  return out;
}

const Run* RunStore::find_by_tag(BytesView tag) const {
  const auto found = std::ranges::find_if(by_age_, [&](const Run* one) { return one->definition().tag() == tag; });
  return found == by_age_.end() ? nullptr : *found;
}

void RunStore::remove(const std::string& run) {
  std::erase_if(by_age_, [&](const Run* one) { return one->id() == run; });
  runs_.erase(run);
}

}  // namespace trb::scheduler
