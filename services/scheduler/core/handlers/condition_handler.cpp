#include "services/scheduler/core/handlers/condition_handler.hpp"

#include <algorithm>

#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/run/drafts.hpp"

namespace trb::scheduler {
namespace {

bool same_source(const Run& run, TaskIndex task, const Inquiry& inquiry) {
  return source_of(run.tasks()[task].when.front()) == source_of(inquiry.condition());
}

/// Keeps exactly one inquiry for each source that these tasks' conditions read.
void match_inquiries(Run& run, const std::vector<TaskIndex>& tasks, const std::string& node) {
  std::vector<Inquiry>& inquiries = run.work().inquiries();
  std::erase_if(inquiries, [&](const Inquiry& one) {
    return std::ranges::none_of(tasks, [&](TaskIndex task) { return same_source(run, task, one); });
  });
  for (const TaskIndex task : tasks) {
    const auto asks = [&](const Inquiry& one) { return same_source(run, task, one); };
    if (std::ranges::none_of(inquiries, asks)) inquiries.emplace_back(node, run.tasks()[task].when.front());
  }
}

}  // namespace

void ConditionHandler::on_routes(const RouteTable& table, Step step) const {
  for (Run* run : runs_.touch_all()) {
    for (Inquiry& inquiry : run->work().inquiries()) inquiry.on(table, step.now, step.out);
  }
}

void ConditionHandler::handle(const SensorReading& body, const Inbound& from, Step step) {
  bool used = false;
  for (Run* run : runs_.touch_all()) {
    for (Inquiry& inquiry : run->work().inquiries()) {
      if (!inquiry.on(body, from.source, step.now)) continue;
      choose(body, from.source, *run, inquiry, step);
      used = true;
    }
  }
  if (!used) step.out.count("unused.sensor_reading");
}

void ConditionHandler::on_refusal(const Nack& nack, const Inbound& from, Step step) {
  for (Run* run : runs_.touch_all()) {
    for (Inquiry& inquiry : run->work().inquiries()) inquiry.on_refusal(nack, from.source, step.now);
  }
}

/// Every condition that waits for this reading is evaluated at once: 19.9 and 20.1 never run both branches.
void ConditionHandler::choose(const SensorReading& reading, const std::string& node, const Run& run, Inquiry& inquiry,
                              Step step) const {
  std::vector<TaskIndex> tasks = run.open_tasks().to_choose();
  std::erase_if(tasks, [&](TaskIndex task) { return !same_source(run, task, inquiry); });
  if (tasks.empty()) return;
  inquiry.sign(encode(choice_by(run, tasks, node, reading, step.now.utc)), step.now, step.out);
}

void ConditionHandler::inquire(Run& run, Step step) const {
  if (!run.may_start(step.steady)) return run.work().inquiries().clear();
  if (!run.definition().has_conditions()) return;
  const std::vector<TaskIndex> open = run.open_tasks().to_choose();
  match_inquiries(run, open, node_);
  for (Inquiry& inquiry : run.work().inquiries()) {
    inquiry.tick(step.now, step.out);
    if (!inquiry.take_update()) continue;
    const auto first = std::ranges::find_if(open, [&](TaskIndex task) { return same_source(run, task, inquiry); });
    notify_wait(run, *first, inquiry.obstacle(), step);
  }
}

void ConditionHandler::notify_wait(const Run& run, TaskIndex task, const std::string& what, Step step) const {
  const TaskProgress progress{{run.id(), run.tasks()[task].id, 1, 1}, node_, TaskState::waiting, what};
  for (const std::string& cloud : run.members().clouds_without(node_)) step.out.information(cloud, progress);
}

bool ConditionHandler::keep_signed(Run& run, const SignedRecord& record, Step step) {
  std::vector<Inquiry>& inquiries = run.work().inquiries();
  const auto inquiry = std::ranges::find_if(inquiries, [&](const Inquiry& one) { return one.signs(record); });
  if (inquiry == inquiries.end()) return false;
  auto held = run.checks().choice(record);
  if (!held) {
    log_wrong_signature(held.error(), step);
    return true;
  }
  const TaskIndex first = *run.index_of(held->choice.tasks.front().task);
  if (!inquiry->obstacle().empty()) notify_wait(run, first, {}, step);
  inquiries.erase(inquiry);
  journal_.keep_choice(run, std::move(*held), step);
  return true;
}

}  // namespace trb::scheduler
