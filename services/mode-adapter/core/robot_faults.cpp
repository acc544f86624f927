#include "services/mode-adapter/core/robot_faults.hpp"

#include <algorithm>

#include "common/fleet/did_you_mean.hpp"
#include "proto/value.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kMaxCapability = 64;
constexpr std::size_t kMaxFaultText = 1024;
constexpr std::size_t kMaxShortText = 255;

std::string name_of_whole(const std::string& capability) {
  return capability.empty() ? "the robot" : "'" + capability + "'";
}

}  // namespace

RobotFaults::RobotFaults(RobotSide& robot, SkillDesk& desk, PersistOutOfUse keep)
    : robot_(robot),
      desk_(desk),
      rules_(robot.settings.description.faults),
      book_(robot.settings.out_of_use, std::move(keep)) {}

void RobotFaults::on_values(const Driver& mode, Now now, Outbox& out) {
  FaultChanges changes;
  for (const FaultRule& rule : robot_.settings.description.faults) {
    if (const RobotValue* value = mode.value(rule.value)) rules_.on_value(rule.value, *value, now, changes);
  }
  notify(changes, now, out);
}

void RobotFaults::on_value(std::string_view name, const RobotValue& value, Now now, Outbox& out) {
  FaultChanges changes;
  rules_.on_value(name, value, now, changes);
  notify(changes, now, out);
}

void RobotFaults::tick(Now now, Outbox& out) {
  FaultChanges changes;
  rules_.tick(now, changes);
  notify(changes, now, out);
}

void RobotFaults::notify(const FaultChanges& changes, Now now, Outbox& out) {
  for (const FaultOver& over : changes.over) on_over(over, now, out);
  for (const FaultSaid& fault : changes.said) on_fault(fault, now, out);
}

std::optional<MonotonicTime> RobotFaults::next_deadline() const {
  return earlier(rules_.next_deadline(), book_.next_deadline());
}

void RobotFaults::on_fault(const FaultSaid& fault, Now now, Outbox& out) {
  const std::string text = cut_utf8(fault.text, kMaxFaultText);
  keep(fault, now, out);
  if (!fault.is_new) return;
  out.count("from_robot.robot_fault");
  out.log(LogLevel::warning, "robot_fault",
          fault.capability + " " + std::string(name_of(fault.severity)) + " " + fault.text);
  for (const std::string& capability : concerned(fault.capability.substr(0, kMaxCapability))) {
    out.information(std::string(kEveryNode), RobotFault{capability, fault.severity, text});
    desk_.on_fault(capability, fault.severity, text, now, out);
  }
}

/// The capabilities concerned; without a name all of them.
std::vector<std::string> RobotFaults::concerned(const std::string& capability) const {
  return capability.empty() ? robot_.settings.description.capabilities : std::vector{capability};
}

void RobotFaults::keep(const FaultSaid& fault, Now now, Outbox& out) {
  if (!knows_capability(fault.capability)) return;
  if (fault.severity < Severity::critical) {
    // The same cause has become milder.
    if (!fault.cause.empty()) on_over(FaultOver{fault.cause}, now, out);
    return;
  }
  const std::string cause = fault.cause.empty() ? "said " + fault.capability : fault.cause;
  OutOfUse what{fault.capability, fault.severity, cut_utf8(fault.text, kMaxShortText), now.utc.ns, false, {}};
  (void)book_.add({cause, std::move(what), fault.lasts && !fault.cause.empty()}, now, out);
}

void RobotFaults::on_over(const FaultOver& over, Now now, Outbox& out) {
  if (const auto ended = book_.end(over.cause, now, out)) notify_end(*ended, ended->text, out);
}

void RobotFaults::notify_end(const OutOfUse& ended, const std::string& text, Outbox& out) {
  out.log(LogLevel::info, "fault_over", name_of_whole(ended.capability) + ": " + text);
  for (const std::string& capability : concerned(ended.capability)) {
    if (book_.faulty(capability)) continue;
    out.information(std::string(kEveryNode), RobotFault{capability, ended.severity, text, true});
  }
}

bool RobotFaults::knows_capability(const std::string& capability) const {
  const auto& known = robot_.settings.description.capabilities;
  return capability.empty() || std::ranges::find(known, capability) != known.end();
}

Status RobotFaults::may_take_out(const Inbound& message, const OutOfUse& what) const {
  if (!what.retired && message.source != robot_.settings.id) {
    return fail(Errc::not_permitted, "only the robot and the services of its node tell a fault",
                "trb robot retire " + robot_.settings.id);
  }
  if (what.retired && !what.capability.empty()) {
    return fail(Errc::bad_value, "what.capability: a robot is retired as a whole", "leave it empty");
  }
  if (what.retired && what.by.empty()) return fail(Errc::missing, "what.by: nobody is named", "say whose word it is");
  if (knows_capability(what.capability)) return Done{};
  return fail(Errc::bad_value, "what.capability: the robot has no '" + what.capability + "'",
              did_you_mean(what.capability, robot_.settings.description.capabilities, "use one of"));
}

void RobotFaults::on_take_out(const Inbound& message, const TakeOutOfUse& order, Now now, Outbox& out) {
  if (Status may = may_take_out(message, order.what); !may) return out.nack(message, may.error());
  OutOfUse what = order.what;
  what.since = now.utc.ns;
  what.severity = std::max(what.severity, Severity::critical);
  if (what.by.empty()) what.by = "a service of the node";
  out.log(LogLevel::warning, what.retired ? "retired" : "out_of_use",
          name_of_whole(what.capability) + ", by " + what.by + ": " + what.text);
  const std::string cause = what.retired ? kRetired : "service " + what.capability;
  const Status saved = book_.add({cause, std::move(what)}, now, out);
  if (saved) return out.reply(message, Ack{"out_of_use", ""});
  out.nack(message,
           fail(saved.error().code,
                "it is out of use, but that is not on disk and would be lost in a restart: " + saved.error().what,
                saved.error().hint));
}

void RobotFaults::on_take_in(const Inbound& message, const TakeIntoUse& order, Outbox& out) {
  const Status done = order.retired ? returned(order, out) : repaired(order, out);
  if (!done) return out.nack(message, done.error());
  out.reply(message, Ack{"in_use", ""});
}

Status RobotFaults::returned(const TakeIntoUse& order, Outbox& out) {
  if (!order.capability.empty()) {
    return fail(Errc::bad_value, "capability: a robot returns as a whole", "leave it empty");
  }
  if (Status done = book_.returned(); !done) return done;
  out.log(LogLevel::info, "returned", "by " + order.by);
  return Done{};
}

Status RobotFaults::repaired(const TakeIntoUse& order, Outbox& out) {
  if (!knows_capability(order.capability)) {
    return fail(Errc::bad_value, "capability: the robot has no '" + order.capability + "'",
                did_you_mean(order.capability, robot_.settings.description.capabilities, "use one of"));
  }
  if (const FaultSaid* fault = rules_.standing(order.capability)) {
    return fail(Errc::conflict, "it still says \"" + fault->text + "\"",
                "mend it until the robot itself says so no more");
  }
  const auto ended = book_.repaired(order.capability, robot_.primary().online());
  if (!ended) return ended.error();
  rules_.begin_again(order.capability);
  for (const OutOfUse& one : *ended) notify_end(one, "repaired, says " + order.by, out);
  return Done{};
}

std::optional<Error> RobotFaults::refusal(const Execute& order) const {
  const Skill* skill = robot_.settings.description.find_skill(order.skill);
  return skill == nullptr ? refusal({}, nullptr) : refusal(skill->capability);
}

std::optional<Error> RobotFaults::refusal(const std::string& capability) const {
  // A fault that is not reported yet, because it began again soon after its end, counts as well.
  return refusal(capability, rules_.standing(capability));
}

std::optional<Error> RobotFaults::refusal(const std::string& capability, const FaultSaid* standing) const {
  const OutOfUse* kept = book_.keeps_out(capability);
  if (kept != nullptr && kept->retired) {
    return fail(Errc::out_of_use, "the robot is retired by " + kept->by + ": " + kept->text,
                "trb robot return " + robot_.settings.id);
  }
  if (kept == nullptr && standing == nullptr) return std::nullopt;
  return fail(Errc::out_of_use,
              name_of_whole(capability) + " is out of use: " + (kept != nullptr ? kept->text : standing->text),
              standing != nullptr ? "mend it: it ends once the robot no longer reports it"
                                  : "mend it, then trb robot repaired " + robot_.settings.id);
}

}  // namespace trb::adapter
