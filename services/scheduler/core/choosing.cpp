// SchedulerCore: conditions of tasks. What could start is asked for, chosen once, journaled; what is not to be done is
// SKIPPED, and its robot not bothered.
#include <algorithm>
#include <set>

#include "services/scheduler/core/scheduler_core.hpp"

namespace trb {

using namespace scheduler;

namespace {

bool same_source(const Run& run, TaskIndex task, const Inquiry& inquiry) {
  return source_of(run.tasks()[task].when.front()) == source_of(inquiry.condition());
}

}  // namespace

void SchedulerCore::decide(Run& run, Step step) {
  const bool open = may_start(run, step.steady);
  if (!open) run.inquiries.clear();
  if (open && run.has_conditions()) inquire(run, step);
  say_results(run, open, step);
}

void SchedulerCore::inquire(Run& run, Step step) {
  const std::vector<TaskIndex> open = run.to_choose();
  const auto find_inquiry = [&](TaskIndex task) {
    return std::find_if(run.inquiries.begin(), run.inquiries.end(),
                        [&](const Inquiry& one) { return same_source(run, task, one); });
  };
  std::erase_if(run.inquiries, [&](const Inquiry& one) {
    return std::none_of(open.begin(), open.end(), [&](TaskIndex task) { return same_source(run, task, one); });
  });
  for (const TaskIndex task : open) {
    if (find_inquiry(task) == run.inquiries.end()) {
      run.inquiries.emplace_back(settings_.node, run.tasks()[task].when.front());
    }
  }
  for (Inquiry& inquiry : run.inquiries) {
    inquiry.tick(step.now, step.out);
    if (!inquiry.take_news()) continue;
    const auto first =
        std::find_if(open.begin(), open.end(), [&](TaskIndex task) { return same_source(run, task, inquiry); });
    tell_waiting(run, *first, inquiry.obstacle(), step);
  }
}

void SchedulerCore::tell_waiting(const Run& run, TaskIndex task, const std::string& what, Step step) {
  const TaskProgress progress{{run.id(), run.tasks()[task].id, 1, 1}, settings_.node, TaskState::waiting, what};
  for (const std::string& cloud : run.clouds()) step.out.information(cloud, progress);
}

/// Results that need no robot: SKIPPED, given back, what has yet to get a robot, and what cannot be begun.
void SchedulerCore::say_results(Run& run, bool open, Step step) {
  std::set<TaskIndex> wanted;
  const auto say = [&](TaskIndex task, const auto& result) {
    wanted.insert(task);
    const auto [at, is_new] = run.skips.try_emplace(task);
    if (is_new) at->second = {std::string(kSignedResult), encode(result()), step.now.mono};
    at->second.tick(settings_.node, step.now, step.out);
  };
  const UtcTime now = step.now.utc;
  if (!run.aborted() && !run.ended() && !run.expired(step.steady)) {
    for (const TaskIndex task : run.releasable()) say(task, [&] { return run.released_result(task, now); });
  }
  if (open) {
    for (const TaskIndex task : run.to_bind()) say(task, [&] { return run.released_result(task, now); });
  }
  if (open && run.may_skip()) {
    for (const TaskIndex task : run.skippable()) say(task, [&] { return run.skipped_result(task, now); });
  }
  for (const auto& [task, why] : run.unbegun) {
    if (open) say(task, [&, of = task, text = why] { return run.unbegun_result(of, text, now); });
  }
  std::erase_if(run.skips, [&](const auto& one) { return !wanted.contains(one.first); });
}

/// Evaluates every condition that waits for this reading, at once: 19.9 and 20.1 never run both branches.
void SchedulerCore::choose_by(const SensorReading& reading, const std::string& node, Run& run, Inquiry& inquiry,
                              Step step) {
  Choice choice;
  choice.run = run.id();
  choice.digest = run.start().digest;
  choice.epoch = run.epoch();
  choice.by = settings_.node;
  for (const TaskIndex task : run.to_choose()) {
    if (!same_source(run, task, inquiry)) continue;
    choice.tasks.push_back({run.tasks()[task].id, 1, holds(run.tasks()[task].when.front(), reading)});
  }
  choice.node = node;
  choice.reading = reading;
  choice.time = step.now.utc.ns;
  if (!choice.tasks.empty()) inquiry.sign(encode(choice), step.now, step.out);
}

void SchedulerCore::keep_choice(Run& run, HeldChoice held, Step step) {
  const std::string name = "run " + run.id() + ": ";
  for (const ChosenTask& chosen : held.choice.tasks) {
    const HeldChoice* known = run.choice_on(*run.index_of(chosen.task));
    if (known == nullptr || known->record.payload == held.record.payload) continue;
    step.out.count("double_choice");
    step.out.log(LogLevel::error, "double_choice",
                 name + "'" + held.choice.by + "' has chosen twice on task '" + chosen.task + "'; the first one holds");
  }
  const SignedRecord record = held.record;
  const Choice choice = held.choice;
  if (!run.add(std::move(held))) return;
  step.out.record(JournalChoice{record});
  for (const ChosenTask& chosen : choice.tasks) {
    const Condition& condition = run.tasks()[*run.index_of(chosen.task)].when.front();
    step.out.log(LogLevel::info, "choice_kept",
                 name + "task '" + chosen.task + "': " + verdict_text(condition, choice.node, choice.reading));
  }
}

bool SchedulerCore::keep_signed_choice(Run& run, const SignedRecord& record, Step step) {
  const auto inquiry =
      std::find_if(run.inquiries.begin(), run.inquiries.end(), [&](const Inquiry& one) { return one.signs(record); });
  if (inquiry == run.inquiries.end()) return false;
  auto held = run.check_choice(record);
  if (!held) return wrong_signature(held.error(), step);
  const TaskIndex first = *run.index_of(held->choice.tasks.front().task);
  if (!inquiry->obstacle().empty()) tell_waiting(run, first, {}, step);
  run.inquiries.erase(inquiry);
  keep_choice(run, std::move(*held), step);
  return true;
}

bool SchedulerCore::keep_signed_skip(Run& run, const SignedRecord& record, Step step) {
  const auto skip =
      std::find_if(run.skips.begin(), run.skips.end(), [&](const auto& one) { return one.second.asks_for(record); });
  if (skip == run.skips.end()) return false;
  auto held = run.check_result(record);
  if (!held) return wrong_signature(held.error(), step);
  run.skips.erase(skip);
  keep_result(run, std::move(*held), step);
  return true;
}

bool SchedulerCore::wrong_signature(const Error& error, Step step) {
  step.out.log(LogLevel::error, "own_signature_wrong", error.text());
  return true;
}

}  // namespace trb
