#include "services/resilience/core/run_watcher.hpp"

#include <algorithm>

#include "proto/body.hpp"

namespace trb::resilience {
namespace {

constexpr double kLease_s = 10;
constexpr Duration kRenew = std::chrono::seconds(5);
constexpr Duration kWarnAgain = std::chrono::minutes(1);

}  // namespace

void RunWatcher::on_welcome(std::string node) {
  node_ = std::move(node);
  has_table_ = false;
  is_watched_ = false;
  watch_.restart();
  for (auto& [run, asking] : asking_) asking = {};
}

void RunWatcher::take(const RunSummary& summary, Now now) {
  if (is_over(summary.state)) return forget(summary.run, summary.state);
  const auto [at, is_new] = runs_.try_emplace(summary.run);
  WatchedRun& run = at->second;
  const bool same = !is_new && run.summary.version == summary.version && run.summary.state == summary.state &&
                    run.summary.epoch == summary.epoch && run.summary.tasks_final == summary.tasks_final &&
                    run.summary.recovers == summary.recovers;
  run.summary = summary;
  constexpr double kLongest_s = 1e9;
  if (summary.left_s > 0) {
    run.ends_at = now.mono + seconds(std::min(summary.left_s, kLongest_s));
    timed_.insert(summary.run);
  }
  if (!same) refresh(summary.run);
}

void RunWatcher::forget(const std::string& run, std::optional<RunState> state) {
  asking_.erase(run);
  if (runs_.erase(run) == 0) return;
  changed_.insert(run);
  if (!state) return;
  ended_.emplace_back(run, *state);
  if (ended_.size() > kMaxEnded) ended_.pop_front();
}

std::optional<RunState> RunWatcher::ended(std::string_view run) const {
  const auto at = std::find_if(ended_.rbegin(), ended_.rend(), [&](const auto& one) { return one.first == run; });
  return at == ended_.rend() ? std::nullopt : std::optional(at->second);
}

const WatchedRun* RunWatcher::find(std::string_view run) const {
  const auto at = runs_.find(run);
  return at == runs_.end() ? nullptr : &at->second;
}

void RunWatcher::refresh(std::string_view run) {
  if (find(run) == nullptr) return;
  Asking& asking = asking_[std::string(run)];
  asking.view_wanted = true;
  if (!asking.view_asked) asking.view.restart();
}

void RunWatcher::on(const RunTable& table, Now now) {
  std::set<std::string> named;
  for (const RunSummary& summary : table.runs) {
    named.insert(summary.run);
    take(summary, now);
  }
  std::map<std::string, bool> gone;  // by run: whether its life was over
  for (const auto& [id, run] : runs_) {
    if (!named.contains(id)) gone[id] = run.ends_at && *run.ends_at <= now.mono;
  }
  for (const auto& [id, late] : gone) forget(id, late ? std::optional(RunState::expired) : std::nullopt);
  has_table_ = true;
  is_watched_ = true;
  watch_.restart();
  renew_at_ = now.mono + kRenew;
}

void RunWatcher::on(const RunChanged& changed, Now now) {
  take(changed.run, now);
}

void RunWatcher::on(const RunView& view) {
  const auto at = runs_.find(view.run);
  if (at == runs_.end()) return;
  if (is_over(view.state)) return forget(view.run, view.state);
  at->second.view = view;
  Asking& asking = asking_[view.run];
  if (!asking.unanswered.empty()) {
    at->second.view_as_of = asking.unanswered.front();
    asking.unanswered.pop_front();
  }
  asking.view_asked = false;
  if (asking.view_wanted) asking.view.restart();
  changed_.insert(view.run);
}

void RunWatcher::on(const Definition& definition) {
  auto start = decode<RunStart>(definition.start.payload.bytes);
  const auto at = start ? runs_.find(start->run) : runs_.end();
  if (at == runs_.end()) return;
  std::vector<Decision> decisions;
  for (const SignedRecord& record : definition.decisions) {
    auto decision = decode<Decision>(record.payload.bytes);
    if (!decision || decision->epoch != decisions.size() + 2) return;  // requested again
    decisions.push_back(std::move(*decision));
  }
  WatchedRun& run = at->second;
  run.start = std::move(*start);
  run.decisions = std::move(decisions);
  run.last_decision = definition.decisions.empty() ? Bytes() : definition.decisions.back().payload.bytes;
  run.learn_certificates();
  const std::string& id = run.start->run;
  if (run.is_current()) asking_[id].definition.restart();
  if (run.view && run.decisions.size() + 1 > run.view->epoch) refresh(id);
  changed_.insert(id);
}

void RunWatcher::on_nack(const Nack& nack, Now now, Outbox& out) {
  out.count("nacked." + nack.subtype);
  if (nack.subtype == RunWatch::kSubtype) is_watched_ = false;
  if (warned_at_ && now.mono - *warned_at_ < kWarnAgain) return;
  warned_at_ = now.mono;
  out.log(LogLevel::warning, "runs_not_seen", "the scheduler: " + nack.subtype + ": " + nack.code + ": " + nack.what);
}

void RunWatcher::tick(Now now, Outbox& out) {
  if (node_.empty()) return;
  if (is_watched_ ? renew_at_ <= now.mono : watch_.is_due(now.mono)) {
    watch_.on_sent(now.mono);
    renew_at_ = now.mono + kRenew;
    out.request(node_, RunWatch{kLease_s});
  }
  for (auto& [id, asking] : asking_) {
    if (asking.view_wanted || asking.view_asked) {
      if (asking.view.is_due(now.mono)) {
        asking.view.on_sent(now.mono);
        asking.view_wanted = false;
        asking.view_asked = true;
        std::erase_if(asking.unanswered, [&](MonotonicTime at) { return at + kAnswerLost < now.mono; });
        asking.unanswered.push_back(now.mono);
        out.request(node_, RunQuery{id});
      }
    }
    if (wants_definition(runs_.at(id)) && asking.definition.is_due(now.mono)) {
      asking.definition.on_sent(now.mono);
      out.request(node_, NeedDefinition{id, {}});
    }
  }
}

std::optional<MonotonicTime> RunWatcher::next_deadline() const {
  if (node_.empty()) return std::nullopt;
  std::optional<MonotonicTime> out = is_watched_ ? renew_at_ : watch_.due_at();
  for (const auto& [id, asking] : asking_) {
    if (asking.view_wanted || asking.view_asked) out = earlier(out, asking.view.due_at());
    if (wants_definition(runs_.at(id))) out = earlier(out, asking.definition.due_at());
  }
  return out;
}

}  // namespace trb::resilience
