#include "services/scheduler/core/handlers/definition_handler.hpp"

#include <utility>

#include "services/scheduler/core/refusal.hpp"

namespace trb::scheduler {
namespace {

constexpr Duration kRoutesPatience = std::chrono::seconds(1);
/// A run that is over stays known until its end. So far apart are clocks only if one is wrong; a robot that has no
/// clock without power may well be some months behind.
constexpr Duration kFarthest = std::chrono::hours(24 * 366);

Error unexpected() {
  return fail(Errc::unknown_run, "a definition that nothing waits for");
}

}  // namespace

/// The run does not begin in a far future. A node that is before its own certificate is behind: it judges nobody's
/// clock.
Status DefinitionHandler::check_created(const Run& run, UtcTime steady) const {
  const Certificate* own = run.members().find(node_);
  const bool is_behind = own != nullptr && steady.ns < own->not_before;
  if (is_behind || run.definition().start().created - kFarthest.count() <= steady.ns) return Done{};
  return fail(Errc::bad_value, "run " + run.id() + " is over a year ahead of this node's time",
              "compare the nodes' clocks (trb doctor), and begin it anew");
}

/// The run is not expired, begins in no far future, and there is room for it.
Status DefinitionHandler::check_new(const Run& run, Step step) const {
  if (auto created = check_created(run, step.steady); !created) return created;
  if (run.definition().expired(step.steady)) {
    return fail(Errc::expired, "run " + run.id() + " has expired before it came here",
                "compare the nodes' clocks (trb doctor), or give it a longer life: --expires-h");
  }
  const std::string& submitter = run.definition().start().submitter;
  if (runs_.bytes_left(submitter) < run.definition().record().payload.bytes.size()) {
    return fail(Errc::queue_full,
                "'" + submitter + "' has its share of the " + std::to_string(RunStore::kMostBytes >> 20U) +
                    " MiB that open runs may take here, with its runs and its results",
                "abort those that nobody needs: trb run list");
  }
  if (runs_.has_place_for(submitter)) return lookup_.has_room(submitter);
  const std::string open = std::to_string(RunStore::kMaxRuns) + " runs are open here";
  return fail(Errc::queue_full,
              runs_.full() ? open
                           : "'" + submitter + "' has its share of the " + std::to_string(RunStore::kMaxRuns) +
                                 " runs that may be open here",
              "abort those that nobody needs: trb run list");
}

void DefinitionHandler::handle(const RunSubmit& body, const Inbound& from, Step step) {
  if (from.source != node_) {
    return refuse(from, fail(Errc::not_permitted, "a run is submitted on the submitter's own node"), step);
  }
  // Whoever gave it was told that there was no answer in time, and may have given it again under another id.
  if (from.remaining_ms == 0) {
    return refuse(from, fail(Errc::expired, "its deadline had passed when it came to the scheduler", "submit it again"),
                  step);
  }
  auto run = runs_.open(body.start);
  if (!run) return refuse(from, run.error(), step);
  const std::string id = (*run)->id();
  if (!(*run)->members().contains(node_)) {
    return refuse(from, fail(Errc::bad_value, "node '" + node_ + "' is no member of run " + id), step);
  }
  if (const auto over = lookup_.over(id)) return lookup_.refuse_over(id, *over, from, step);
  if (auto submitted = submit(std::move(*run), runs_.find(id), step); !submitted) {
    return refuse(from, submitted.error(), step);
  }
  step.out.reply(from, RunAccepted{id});
}

Status DefinitionHandler::submit(std::unique_ptr<Run> run, Run* known, Step step) {
  if (known == nullptr) {
    if (auto checked = check_new(*run, step); !checked) return checked;
    journal_.add(std::move(run), true, step);
    return Done{};
  }
  if (known->definition().record().payload != run->definition().record().payload) {
    return fail(Errc::conflict, "run " + run->id() + " is known with another start", "draw a new run id");
  }
  return known->deliveries().submitted_here() ? Done{} : journal_.note_submitted(*known, step);
}

void DefinitionHandler::handle(const NeedDefinition& body, const Inbound& from, Step step) {
  Run* run = lookup_.find(body.run, from, step);
  if (run == nullptr) return;
  run->deliveries().note_reads_short(from.source, body.reads_short);
  if (!body.digest.bytes.empty() && body.digest != run->definition().start().digest) {
    return refuse(from, fail(Errc::conflict, "run " + body.run + " has another definition"), step);
  }
  Definition answer{run->definition().record(), run->epochs().records(), run->orders().records()};
  if (const Blob* compact = body.compact ? run->definition().compact(body.reads_short) : nullptr) {
    answer.compact = *compact;
    answer.counts_on = body.reads_short;
    answer.start.payload = {};
  }
  step.out.reply(from, std::move(answer));
}

void DefinitionHandler::handle(const Definition& body, const Inbound& from, Step step) {
  if (!body.compact.bytes.empty()) return handle_compact(from, step, true);
  const auto claimed = decode<RunStart>(body.start.payload.bytes);
  if (Run* known = claimed ? runs_.find(claimed->run) : nullptr) return handle_more(*known, body, from, step);
  if (!claimed || !lookup_.awaits_definition(claimed->run, from.source)) return refuse(from, unexpected(), step);
  take(body, *claimed, from, step);
}

/// `may_wait`: the own router has not been asked since it came.
void DefinitionHandler::handle_compact(const Inbound& from, Step step, bool may_wait) {
  Definition whole = get<Definition>(from.body);
  auto claimed = open_compact_start(std::exchange(whole.compact, {}), whole.counts_on);
  if (!claimed) return refuse(from, claimed.error(), step);
  // Of a run that is known by now nothing is missing: its later decisions are requested by themselves.
  if (!lookup_.awaits_definition(claimed->run, from.source) || runs_.find(claimed->run) != nullptr) {
    return refuse(from, unexpected(), step);
  }
  if (const auto complete = certificates_.complete(*claimed)) whole.start.payload.bytes = encode(*complete);
  if (runs_.open(whole.start)) return take(whole, *claimed, from, step);
  // A member is new or has a new certificate: the own router may know it by now; if not, the sender does.
  may_wait ? wait_for_routes(claimed->run, from, step) : request_whole(claimed->run, from, step);
}

void DefinitionHandler::wait_for_routes(const std::string& run, const Inbound& from, Step step) {
  // Bounded as what waits for a definition is: another one of the same sender takes the older one's place.
  std::erase_if(waiting_, [&](const Inbound& one) {
    const auto& waits = get<Definition>(one.body);
    const auto older = open_compact_start(waits.compact, waits.counts_on);
    return !older || !lookup_.awaits_definition(older->run, one.source) ||
           (older->run == run && one.source == from.source);
  });
  waiting_.push_back(from);
  // One table answers all; a request that was lost is sent again with the next definition.
  if (routes_asked_ && step.now.mono < *routes_asked_ + kRoutesPatience) return;
  routes_asked_ = step.now.mono;
  step.out.request(node_, RouteListRequest{});
}

void DefinitionHandler::on_routes(const RouteTable& table, Step step) {
  routes_asked_.reset();
  certificates_.learn(table);
  for (const Inbound& one : std::exchange(waiting_, {})) handle_compact(one, step, false);
}

void DefinitionHandler::request_whole(const std::string& run, const Inbound& from, Step step) {
  step.out.counts.emplace_back("definition.whole");  // made in place: GCC 12 warns in vain of moving 16 characters
  step.out.request(from.source, NeedDefinition{run, {}, false, true});
}

/// A whole definition that a message waits for.
void DefinitionHandler::take(const Definition& body, const RunStart& claimed, const Inbound& from, Step step) {
  auto run = runs_.open(body.start);
  Status checked = run ? check_new(**run, step) : Status(run.error());
  if (checked && !makes_member(**run, body)) {
    checked = fail(Errc::not_permitted, "node '" + node_ + "' is no member of run " + claimed.run);
  }
  if (!checked) {
    step.out.log(LogLevel::warning, "definition_refused", "from '" + from.source + "': " + checked.error().text());
    return lookup_.refuse_deferred(claimed.run, from.source, checked.error(), step);
  }
  const bool is_first = body.decisions.empty() && lookup_.is_first_passed(claimed);
  Run& added = journal_.learn(std::move(*run), is_first, step);
  keep_decisions(added, body, from, step);
  keep_orders(added, body, from, step);
  lookup_.hand_out(added.id(), dispatch_, step);
}

/// This node is a member by the start, or by the decisions that come with it. Else anybody could fill its journal.
bool DefinitionHandler::makes_member(const Run& run, const Definition& body) const {
  if (run.members().contains(node_)) return true;
  const auto later = runs_.open(body.start);  // as the run will be; nothing of it is kept
  for (const SignedRecord& decision : body.decisions) {
    if (!later || !(*later)->decision_checks().decision(decision)) return false;
    if (!(*later)->apply(JournalDecision{decision, false})) return false;
  }
  return later && (*later)->members().contains(node_);
}

/// The answer of a node that was asked for decisions.
void DefinitionHandler::handle_more(Run& run, const Definition& body, const Inbound& from, Step step) {
  const bool recovers = run.is_recovering() && from.reply_to != 0 && run.members().contains(from.source);
  const bool expected = run.work().awaited().settle_decisions(from.source) || recovers;
  if (!expected || body.start.payload != run.definition().record().payload) return refuse(from, unexpected(), step);
  const bool decisions = keep_decisions(run, body, from, step);
  // Who has sent them to this node owes them no more, though its journal was lost since.
  const bool orders = keep_orders(run, body, from, step);
  if (recovers && decisions && orders) run.recovery().note_decisions(from.source);
  lookup_.hand_out(run.id(), dispatch_, step);
}

bool DefinitionHandler::keep_decisions(Run& run, const Definition& body, const Inbound& from, Step step) {
  const Status kept = journal_.keep_decisions(run, body.decisions, step);
  if (!kept) step.out.log(LogLevel::warning, "decisions_refused", "from '" + from.source + "': " + kept.error().text());
  return kept.ok();
}

bool DefinitionHandler::keep_orders(Run& run, const Definition& body, const Inbound& from, Step step) {
  const Status kept = journal_.keep_orders(run, body.orders, step);
  if (!kept) step.out.log(LogLevel::warning, "orders_refused", "from '" + from.source + "': " + kept.error().text());
  return kept.ok();
}

}  // namespace trb::scheduler
