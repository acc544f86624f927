#include "services/scheduler/core/handlers/baton_handler.hpp"

#include <algorithm>

#include "common/base/errc.hpp"
#include "services/scheduler/core/refusal.hpp"

namespace trb::scheduler {
namespace {

/// All of them, or the error of the first bad one.
template <class Held, class Check>
Result<std::vector<Held>> check_all(const std::vector<SignedRecord>& records, const Check& check) {
  std::vector<Held> out;
  for (const SignedRecord& record : records) {
    auto held = check(record);
    if (!held) return held.error();
    out.push_back(std::move(*held));
  }
  return out;
}

}  // namespace

/// The contents of a baton, checked.
struct BatonHandler::Content {
  std::vector<bool> final_tasks;
  std::vector<bool> skipped_tasks;
  std::vector<HeldResult> results;
  std::vector<HeldChoice> choices;
};

Result<BatonHandler::Content> BatonHandler::open(const Run& run, const Baton& baton) const {
  const auto final_tasks = from_bitmap(baton.final_tasks.bytes, run.tasks().size());
  if (!final_tasks) return final_tasks.error();
  const auto skipped = from_bitmap(baton.skipped_tasks.bytes, run.tasks().size());
  if (!skipped) return skipped.error();
  auto results = check_all<HeldResult>(baton.results,
                                       [&](const SignedRecord& record) { return runs_.received_result(run, record); });
  if (!results) return results.error();
  auto choices =
      check_all<HeldChoice>(baton.choices, [&](const SignedRecord& record) { return run.checks().choice(record); });
  if (!choices) return choices.error();
  return Content{*final_tasks, *skipped, std::move(*results), std::move(*choices)};
}

Status BatonHandler::check(const Run& run, const Baton& baton, Step step) const {
  const std::string name = "run " + run.id() + ": baton: ";
  if (baton.digest != run.definition().start().digest) return fail(Errc::conflict, name + "of another definition");
  if (baton.epoch != run.epochs().current()) {
    return fail(Errc::conflict, name + "of epoch " + std::to_string(baton.epoch) + ", this is epoch " +
                                    std::to_string(run.epochs().current()));
  }
  if (run.definition().expired(step.steady)) return fail(Errc::expired, name + "the run has expired");
  if (run.orders().has_ended()) return fail(Errc::expired, name + "the run has FINISHED");
  for (const TaskIndex task : baton.tasks) {
    if (task >= run.tasks().size() || !run.epochs().concerns(task)) {
      return fail(Errc::bad_value, name + "task " + std::to_string(task) + " is not for '" + node_ + "'");
    }
  }
  return Done{};
}

void BatonHandler::handle(const Baton& body, const Inbound& from, Step step) {
  Run* run = lookup_.find_or_defer(body.run, body.digest, from, step);
  if (run == nullptr || lookup_.defer_for_decisions(*run, body.epoch, from, step)) return;
  if (auto checked = check(*run, body, step); !checked) return refuse(from, checked.error(), step);
  auto content = open(*run, body);
  if (!content) return refuse(from, content.error(), step);
  if (auto kept = journal_.keep_orders(*run, body.orders, step); !kept) return refuse(from, kept.error(), step);
  for (HeldResult& held : content->results) journal_.keep_result(*run, std::move(held), step);
  for (HeldChoice& held : content->choices) journal_.keep_choice(*run, std::move(held), step);
  if (from.source == run->definition().start().submitter && is_first_pass(from.body)) journal_.note_first(*run, step);
  step.out.information(from.source, BatonJournaled{body.run, body.epoch, body.tasks, true});
  if (!run->orders().is_aborted()) run->receive(content->final_tasks, content->skipped_tasks, from.source);
  if (began_long_ago(*run, body.tasks, step.now)) repeat_progress(*run, from, step);
}

/// Did one of these tasks begin long ago? Whoever passes it in its turn does so within seconds.
bool BatonHandler::began_long_ago(const Run& run, const std::vector<TaskIndex>& tasks, Now now) const {
  constexpr Duration kLong = std::chrono::seconds(10);
  if (!executor_.runs(run.id()) || now.utc.ns - executor_.attempt()->result.started < kLong.count()) return false;
  const auto attempted = run.index_of(executor_.attempt()->execute.key.task);
  return attempted && std::ranges::find(tasks, *attempted) != tasks.end();
}

/// A cloud node that passes a task that has begun has lost this node's notice of it in a restart; one that has just got
/// to know the run has refused it.
void BatonHandler::repeat_progress(const Run& run, const Inbound& from, Step step) const {
  const std::vector<std::string> clouds = run.members().clouds_without(node_);
  const bool concerned = executor_.runs(run.id()) && std::ranges::find(clouds, from.source) != clouds.end();
  if (!concerned || executor_.attempt()->phase == Phase::signing) return;
  const bool runs = executor_.attempt()->phase == Phase::running;
  const TaskState state = runs ? TaskState::running : TaskState::initializing;
  step.out.information(from.source, TaskProgress{executor_.attempt()->execute.key, node_, state, ""});
}

void BatonHandler::handle(const BatonJournaled& body, const Inbound& from, Step step) {
  Run* run = lookup_.find(body.run, from, step);
  if (run == nullptr) return;
  run->deliveries().note_reads_short(from.source, body.reads_short);
  if (body.epoch == 0 || body.epoch > run->epochs().current()) {
    return refuse(from, fail(Errc::conflict, "run " + body.run + ": of another epoch"), step);
  }
  // A task that has left and come back in a later epoch has to be passed again.
  if (!run->epochs().is_of_epoch(body.tasks, body.epoch)) return step.out.count("late.baton_journaled");
  run->deliveries().forget_refusal(from.source);
  journal_.keep_delivery(*run, DeliveryKind::baton, from, body.tasks, body.epoch, step);
  repeat_progress(*run, from, step);
}

void BatonHandler::on_refusal(const Nack& nack, const Inbound& from, Step step) {
  Run* run = runs_.find(nack.about);
  if (run == nullptr) return;
  if (nack.code == errc_name(Errc::conflict)) return request_decisions(*run, from, step);
  const bool is_full = nack.code == errc_name(Errc::queue_full);
  if (is_full && run->members().contains(from.source)) run->deliveries().note_refusal(from.source, nack.what);
}

/// A member that refuses a baton may be in a later epoch, and the decider that would send it may be gone.
void BatonHandler::request_decisions(Run& run, const Inbound& from, Step step) {
  const std::vector<std::string> owed = run.deliveries().pending().creditors(DeliveryKind::baton);
  if (std::ranges::find(owed, from.source) == owed.end()) return;
  lookup_.request_decisions(run, from.source, step);
}

}  // namespace trb::scheduler
