#include "services/resilience/core/verdicts.hpp"

#include <algorithm>
#include <cstddef>

#include "common/base/words.hpp"
#include "proto/value.hpp"
#include "services/resilience/core/run_problems.hpp"

namespace trb::resilience {
namespace {

std::string person_of(const Alert& alert) {
  return alert.person.empty() ? "the policy" : "'" + alert.person + "'";
}

/// "was decided by 'ann': accept, drive to pioneer1"
std::string decided_text(const Alert& alert) {
  const std::string verdict(name_of(alert.verdict));
  std::string out = "was decided by " + person_of(alert) + ": " + verdict;
  const bool moves = alert.verdict == Verdict::accept || alert.verdict == Verdict::override_;
  if (!moves || alert.proposals.empty()) return out;
  for (const TaskForRobot& one : alert.proposals.front().tasks) out += ", " + one.task + " to " + one.robot;
  return cut_utf8(out, 512);
}

/// The first named task that the decided alert does not have; empty: none.
std::string other_task(const Alert& alert, const AlertDecide& body) {
  const auto at = std::ranges::find_if_not(body.tasks, [&](const auto& id) { return contains(alert.tasks, id); });
  return at == body.tasks.end() ? std::string() : cut_utf8(*at, 64);
}

constexpr std::size_t kMaxPerson = 64;  ///< of AlertDecide

constexpr const char* kTrbRun = "trb scenario list names the runs, trb scenario watch a run's tasks";

/// The robot that has all of the tasks.
Result<std::string> robot_of(const WatchedRun& run, const std::vector<std::string>& tasks) {
  std::string robot;
  for (const std::string& id : tasks) {
    const auto index = run.find_task(id);
    if (!index) return fail(Errc::bad_value, "tasks: the run contains no task '" + cut_utf8(id, 64) + "'", kTrbRun);
    const TaskView& task = run.view->tasks[*index];
    if (is_final(task)) {
      return fail(Errc::conflict, "task '" + id + "' is " + std::string(name_of(task.state)) + " already", kTrbRun);
    }
    if (task.robot.empty()) {
      return fail(Errc::conflict, "task '" + id + "' names no robot yet", "an alert asks for one when it is due");
    }
    if (!robot.empty() && robot != task.robot) {
      return fail(Errc::bad_value, "tasks: '" + id + "' is of " + task.robot + ", others are of " + robot,
                  "decide on one robot's tasks at a time");
    }
    robot = task.robot;
  }
  return robot;
}

}  // namespace

std::optional<DecidedElsewhere> Verdicts::elsewhere(const AlertDecide& body) const {
  const bool names_both = !body.alert.empty() && !body.run.empty();  // refused, here as there
  if (situation_.settings().role != Role::cloud || names_both) return std::nullopt;
  DecidedElsewhere out{{}, body.run, body.tasks};
  if (!body.alert.empty()) {
    const auto alert = alerts_.book().choose(body.alert);
    if (!alert || !is_open(**alert)) return std::nullopt;
    out.run = (*alert)->run;
    if (out.tasks.empty()) out.tasks = (*alert)->tasks;
  }
  if (out.run.empty() || out.tasks.empty()) return std::nullopt;
  const auto run = choose_run(out.run);
  if (!run || (*run)->decider().empty() || situation_.decides_on(*run)) return std::nullopt;
  out.run = (*run)->summary.run;
  out.node = (*run)->decider();
  return out;
}

Result<AlertDecide> Verdicts::of_other_cloud(AlertDecide body, const std::string& source) {
  if (body.run.empty() || body.tasks.empty()) {
    return fail(Errc::not_permitted, "run: an alert is decided on the node whose alert it is",
                "give the run and its tasks, or use --node");
  }
  const auto run = choose_run(body.run);
  if (!run) return run.error();
  if (!(*run)->is_member(source)) {
    return fail(Errc::not_permitted, "run: '" + source + "' is no member of it", "say it on one of its cloud nodes");
  }
  if (!body.alert.empty()) {
    const auto alert = alert_of_tasks(**run, body.tasks);
    if (!alert) return alert.error();
    if (*alert == nullptr) {
      return fail(Errc::conflict,
                  "alert " + body.alert + ": no alert of its tasks is open on '" + situation_.node() + "'",
                  "it was decided or is over: look at the run");
    }
    body.alert.clear();
  }
  const std::string from = "@" + source;
  body.person = cut_utf8(body.person, kMaxPerson - std::min(kMaxPerson, from.size())) + from;
  return body;
}

Result<std::string> Verdicts::receive(const AlertDecide& body, const std::string& source, Now now, Outbox& out) {
  if (source == situation_.node()) return receive_own(body, now, out);
  const auto theirs = of_other_cloud(body, source);
  return theirs ? receive_own(*theirs, now, out) : theirs.error();
}

Result<std::string> Verdicts::receive_own(const AlertDecide& body, Now now, Outbox& out) {
  if (!body.alert.empty() && !body.run.empty()) {
    return fail(Errc::bad_value, "run: an alert names its run itself", "give the alert, or run and tasks");
  }
  if (body.alert.empty() && !body.run.empty()) return decide_tasks(body, now, out);
  const auto alert = alerts_.book().choose(body.alert);
  return alert ? decide_alert(**alert, body, now, out) : alert.error();
}

Result<std::string> Verdicts::decide_alert(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  if (alert.run.empty()) return decide_lone(alert, body, now, out);
  const bool undecided = alert.verdict == Verdict::none && is_open(alert);
  return undecided ? decide(alert, body, now, out) : decide_again(alert, body, now, out);
}

/// The fault of a robot that no run needs: a person can report that it is over.
Result<std::string> Verdicts::decide_lone(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  if (!is_open(alert)) return fail(Errc::conflict, "alert " + alert.id + " is closed: " + alert.waits_for);
  if (body.verdict != Verdict::retry) {
    return fail(Errc::bad_value, "no run needs " + alert.robot + ": there is nothing to move or to skip",
                "say --retry once it works again");
  }
  if (situation_.is_missing(alert.robot)) return forget_robot(alert, body, now, out);
  if (situation_.settings().role != Role::cloud && !repairs_.still_broken(alert).empty()) {
    return fail(Errc::not_permitted, "this node puts no robot back into use",
                "say it on the cloud's node, or on the robot's: trb robot repaired " + alert.robot);
  }
  if (alert.state == AlertState::releasing) return "alert " + alert.id + " " + decided_text(alert) + " already";
  alert.verdict = body.verdict;
  alert.person = body.person;
  alert.reason = body.reason;
  alert.state = AlertState::releasing;
  repairs_.begin(alert, "said by " + person_of(alert), now);
  out.record(alert);
  standing_.look(alert, now, out);
  if (!is_open(alert)) return alert.robot + " is taken as mended";
  return "alert " + alert.id + " " + decided_text(alert) + "; waits for: " + alert.waits_for;
}

/// Nobody else can tell the end of the faults of a robot that was sold, or has another name since. One that is only
/// away tells its faults anew when it is back.
std::string Verdicts::forget_robot(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  alert.verdict = body.verdict;
  alert.person = body.person;
  alert.reason = body.reason;
  situation_.forget(alert.robot, now);
  standing_.look(alert, now, out);
  return alert.robot + " is not in the router's table: it is forgotten";
}

/// The open alert of the fault, which has outlived this alert.
Alert* Verdicts::alert_of_fault(const Alert& alert) {
  const std::vector<std::string> broken = repairs_.still_broken(alert);
  for (Alert* other : alerts_.open()) {
    const auto tells = [&](const std::string& capability) { return covers(*other, capability); };
    if (other->robot == alert.robot && std::ranges::any_of(broken, tells)) return other;
  }
  return nullptr;
}

/// The alert is over: a person reports that its robot is repaired.
Result<std::string> Verdicts::mend_again(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  const std::string name = "alert " + alert.id + " ";
  repairs_.begin(alert, "said by '" + body.person + "'", now);
  const auto broken = repairs_.still_broken(alert);
  if (broken.empty()) {
    const bool decided = alert.verdict != Verdict::none;
    return alert.robot + " is taken as mended; " + name + (decided ? decided_text(alert) : "is closed");
  }
  Alert* standing = alert_of_fault(alert);
  if (standing == nullptr) standing = standing_.raise({alert.robot, broken.front()}, now, out);
  if (standing == nullptr) return fail(Errc::queue_full, "too many alerts are open", "decide on some: trb alert list");
  if (standing->run.empty()) return decide_lone(*standing, body, now, out);
  return fail(Errc::conflict, name + "is closed: alert " + standing->id + " tells of the fault", "decide on that one");
}

/// The alert was decided before, or its run has ended: repeating the verdict does no harm, --stands may be added, and
/// `retry` reports that the robot is repaired.
Result<std::string> Verdicts::decide_again(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  const std::string name = "alert " + alert.id + " ";
  if (body.verdict == Verdict::retry && !is_open(alert) && !alert.robot.empty())
    return mend_again(alert, body, now, out);
  const std::string other = other_task(alert, body);
  const bool same = alert.verdict == body.verdict && other.empty() &&
                    (alert.proposals.empty() || (is_as_shown(alert.proposals.front(), body.shown) &&
                                                 (body.robot.empty() || alert.proposals.front().robot == body.robot)));
  if (alert.verdict == Verdict::none) return fail(Errc::conflict, name + "is closed: " + alert.waits_for);
  if (!same && decisions_.is_stuck(alert, now)) return decide(alert, body, now, out);
  if (!other.empty()) {
    return fail(Errc::conflict, "tasks: '" + other + "' is not among those on which " + name + decided_text(alert),
                "once that is done, it has an alert of its own if it still needs one: trb alert list");
  }
  if (!same) return fail(Errc::conflict, name + decided_text(alert), "trb alert list --all contains it");
  if (alert.state == AlertState::releasing && body.stands && !alert.needs_word) {
    alert.needs_word = true;
    out.record(alert);
    return name + decided_text(alert) + "; the word that " + alert.robot + " stands is taken";
  }
  return name + decided_text(alert) + " already";
}

Result<std::string> Verdicts::decide(Alert& alert, const AlertDecide& body, Now now, Outbox& out) {
  const WatchedRun* run = situation_.runs().find(alert.run);
  if (Status may = checks_.check_decider(alert, run, body); !may) return may.error();
  Alert next = alert;
  if (alert.state == AlertState::releasing) next.proposals.clear();  // another verdict
  if (Status good = checks_.shape(next, body, *run, now); !good) return good.error();
  alert = std::move(next);
  alerts_.reset_work(alert.id);
  alerts_.work(alert.id).signing.begin(now);
  if (body.verdict == Verdict::retry) repairs_.begin(alert, "said by " + person_of(alert), now);
  out.record(alert);
  out.log(LogLevel::warning, "alert_decided", alert.id + " " + decided_text(alert));
  situation_.note_change();
  situation_.due_runs().notify(alert.run);  // tasks that the verdict leaves out may become an alert
  decisions_.advance(alert, now, out);
  return "alert " + alert.id + " " + decided_text(alert) + "; waits for: " + alert.waits_for;
}

/// Finds the run by a unique beginning of its id.
Result<const WatchedRun*> Verdicts::choose_run(const std::string& beginning) const {
  const WatchedRun* out = nullptr;
  for (const auto& [id, run] : situation_.runs().runs()) {
    if (!id.starts_with(beginning)) continue;
    if (out != nullptr)
      return fail(Errc::bad_value, "'" + beginning + "' is the beginning of several runs", "give more of the id");
    out = &run;
  }
  if (out != nullptr && out->is_known() && situation_.is_judged()) return out;
  return fail(Errc::unknown_run, "run '" + beginning + "' is not known by this node's scheduler now", kTrbRun);
}

/// The open alert of these tasks. Error: it covers only some of them.
Result<Alert*> Verdicts::alert_of_tasks(const WatchedRun& run, const std::vector<std::string>& tasks) {
  for (Alert* alert : alerts_.open()) {
    if (alert->run != run.summary.run || !may_be_ruled(*alert)) continue;
    const auto told = std::ranges::count_if(tasks, [&](const std::string& id) { return contains(alert->tasks, id); });
    if (told == 0) continue;
    if (static_cast<std::size_t>(told) == tasks.size()) return alert;
    return fail(Errc::conflict, "tasks: alert " + alert->id + " tells of some of them",
                "decide on those by themselves");
  }
  return static_cast<Alert*>(nullptr);
}

Result<std::string> Verdicts::decide_tasks(const AlertDecide& body, Now now, Outbox& out) {
  const auto run = choose_run(body.run);
  if (!run) return run.error();
  if (body.tasks.empty()) return fail(Errc::missing, "tasks: which tasks of the run?", "--task T[,T]");
  const auto robot = robot_of(**run, body.tasks);
  if (!robot) return robot.error();
  const auto told = alert_of_tasks(**run, body.tasks);
  if (!told) return told.error();
  if (*told != nullptr) return decide_alert(**told, body, now, out);
  Alert alert = alert_of(**run, *robot, now);
  alert.cause = kAsked;
  alert.text = cut_utf8("asked by '" + body.person + "'" + (body.reason.empty() ? "" : ": " + body.reason), 1024);
  for (const std::string& id : body.tasks) {
    if (!contains(alert.tasks, id)) alert.tasks.push_back(id);
  }
  return decide_anew(std::move(alert), body, now, out);
}

Result<std::string> Verdicts::decide_anew(Alert fresh, const AlertDecide& body, Now now, Outbox& out) {
  Alert* alert = alerts_.raise(std::move(fresh), now, out);
  if (alert == nullptr) return fail(Errc::queue_full, "too many alerts are open", "decide on some: trb alert list");
  auto decided = decide(*alert, body, now, out);
  if (!decided) alerts_.drop(alert->id);
  return decided;
}

}  // namespace trb::resilience
