#include "services/resilience/core/alert_lifecycle.hpp"

#include <algorithm>
#include <limits>

#include "proto/body.hpp"
#include "proto/value.hpp"

namespace trb::resilience {

Alert alert_of(const WatchedRun& run, const std::string& robot, Now now) {
  Alert out;
  out.run = run.summary.run;
  out.name = run.view->name;
  out.robot = robot;
  out.time = now.utc.ns;
  return out;
}

void AlertLifecycle::restore(std::vector<Alert> alerts, const std::vector<StoredDecision>& decisions) {
  for (Alert& alert : alerts) book_.restore(std::move(alert));
  book_.prune();
  for (const StoredDecision& stored : decisions) {
    const auto decision = decode<Decision>(stored.record.payload.bytes);
    if (decision) decided_.insert({decision->run, decision->epoch});
    if (stored.delivered || !decision) continue;
    const Alert* alert = book_.find(decision->alert);
    if (alert == nullptr || alert->state != AlertState::releasing) continue;
    work(alert->id).signing.restore(stored.record, decision->epoch);
  }
}

void AlertLifecycle::keep(const Decision& decision, const SignedRecord& record, Outbox& out) {
  decided_.insert({decision.run, decision.epoch});
  out.record(RunDecision{record});
}

void AlertLifecycle::note_over(const std::string& run) {
  const auto first = decided_.lower_bound({run, 0});
  if (first != decided_.end() && first->first == run) over_.insert(run);
}

void AlertLifecycle::forget_over(Outbox& out) {
  std::erase_if(over_, [&](const std::string& run) {
    if (std::ranges::any_of(open(), [&](const Alert* alert) { return alert->run == run; })) return false;
    decided_.erase(decided_.lower_bound({run, 0}),
                   decided_.upper_bound({run, std::numeric_limits<std::uint32_t>::max()}));
    out.record(DecisionsOver{run});
    return true;
  });
}

AlertWork& AlertLifecycle::work(std::string_view alert) {
  const auto at = works_.find(alert);
  return at == works_.end() ? works_[std::string(alert)] : at->second;
}

const AlertWork* AlertLifecycle::find_work(std::string_view alert) const {
  const auto at = works_.find(alert);
  return at == works_.end() ? nullptr : &at->second;
}

void AlertLifecycle::on_answer(const std::string& robot, const std::string& value) {
  for (auto& [alert, work] : works_) {
    if (work.inquiry.on_answer(robot, value)) situation_.note_change();
  }
}

std::optional<MonotonicTime> AlertLifecycle::next(Now now) const {
  std::optional<MonotonicTime> out;
  for (const auto& [id, work] : works_) {
    for (const auto& at : {work.inquiry.follow_at(), work.repair.next(), work.signing.next(now)}) {
      if (at && *at > now.mono) out = earlier(out, at);
    }
  }
  return out;
}

std::string_view AlertLifecycle::submitter_of(const std::string& run) const {
  const WatchedRun* is = situation_.runs().find(run);
  return is == nullptr || !is->start ? std::string_view() : std::string_view(is->start->submitter);
}

/// Was the run submitted on its decider's node? There are the people who run the fleet; any other member signs as many
/// runs as it wants.
bool AlertLifecycle::is_trusted(const std::string& run) const {
  const WatchedRun* is = situation_.runs().find(run);
  return is == nullptr || !is->start || is->start->submitter == is->decider();
}

Alert* AlertLifecycle::raise(Alert fresh, Now now, Outbox& out) {
  fresh.policy = "ask";
  fresh.expires = fresh.run.empty() ? 0 : (now.utc + situation_.settings().resilience.expires).ns;
  const std::string robot = fresh.robot;
  const bool trusted = is_trusted(fresh.run);
  Alert* alert = book_.add(std::move(fresh), trusted);
  if (alert == nullptr) {
    out.count("dropped.alerts");
    out.log(LogLevel::error, "too_many_alerts",
            "too many alerts are open: none for " + robot + "; decide on some: trb alert list");
  }
  return alert;
}

void AlertLifecycle::drop(const std::string& alert) {
  reset_work(alert);
  book_.drop(alert);
}

void AlertLifecycle::close(Alert& alert, const std::string& why, Outbox& out) {
  alert.state = AlertState::closed;
  if (situation_.runs().find(alert.run) != nullptr) situation_.due_runs().notify(alert.run);
  alert.waits_for = cut_utf8(why, 512);
  reset_work(alert.id);
  record_end(alert, DecisionEnd::dropped, out);
  out.record(alert);
  out.log(LogLevel::info, "alert_closed", alert.id + ": " + why);
}

/// Records what became of the alert's decision, if one was signed.
void AlertLifecycle::record_end(const Alert& alert, DecisionEnd end, Outbox& out) {
  if (alert.epoch == 0) return;
  if (end == DecisionEnd::dropped) decided_.erase({alert.run, alert.epoch});
  out.record(DecisionOver{alert.run, alert.epoch, end});
}

void AlertLifecycle::finish(Alert& alert, Outbox& out) {
  record_end(alert, DecisionEnd::handed, out);
  alert.state = AlertState::decided;
  situation_.due_runs().notify(alert.run);
  alert.waits_for.clear();
  reset_work(alert.id);
  out.record(alert);
  out.log(LogLevel::info, "decision_taken",
          alert.id + ": run " + alert.run.substr(0, 8) + ", epoch " + std::to_string(alert.epoch));
}

void AlertLifecycle::reopen(Alert& alert, const std::string& why, Outbox& out, bool for_good) {
  record_end(alert, DecisionEnd::dropped, out);
  out.log(LogLevel::warning, "alert_reopened", alert.id + ": " + why);
  AlertWork& is = work(alert.id);
  const bool refused = for_good || is.signing.record().has_value();
  alert.state = AlertState::open;
  alert.verdict = Verdict::none;
  alert.person.clear();
  alert.reason.clear();
  alert.epoch = 0;
  alert.text = text_tried(alert.text, why);
  alert.proposals.clear();
  is = {};
  // The policy must not try the same again and again.
  if (refused) is.asks_for = why;
  if (const WatchedRun* run = situation_.runs().find(alert.run); run != nullptr && run->is_known()) {
    situation_.due_runs().notify(alert.run);  // proposals are made anew
    situation_.runs().refresh(alert.run);
  }
  out.record(alert);
}

}  // namespace trb::resilience
