#include "services/cloud-gateway/core/alarms/alarm_desk.hpp"

#include <algorithm>
#include <set>

#include "services/cloud-gateway/core/alarms/chatter.hpp"
#include "services/cloud-gateway/core/alarms/comings.hpp"

namespace trb::gateway {
namespace {

bool came_before(const Alert& a, const Alert& b) {
  return a.time != b.time ? a.time < b.time : a.id < b.id;
}

template <class Row>
void put_changes(const ChangeList<Row>& changes, std::map<std::string, Row>& rows) {
  for (const Change<Row>& one : changes.pending()) {
    if (one.row) rows[one.key] = *one.row;
    if (!one.row) rows.erase(one.key);
  }
}

/// Does `later` probably follow from `earlier`? Of one robot, as long as the first fault stands; of one run, if it came
/// at once.
bool follows(const Alert& later, const Alert& earlier) {
  if (!came_before(earlier, later)) return false;
  if (!later.robot.empty() && later.robot == earlier.robot) return true;
  return !later.run.empty() && later.run == earlier.run && later.time - earlier.time <= kFollowsWithin.count();
}

/// The earliest open alert that this one follows from.
std::string first_of(const Alert& alert, const std::vector<Alert>& alerts) {
  const Alert* out = nullptr;
  for (const Alert& other : alerts) {
    if (!is_open(other) || !follows(alert, other)) continue;
    if (out == nullptr || came_before(other, *out)) out = &other;
  }
  return out == nullptr || !is_open(alert) ? std::string() : out->id;
}

/// The alerts of each source, earliest first.
std::map<std::string, std::vector<const Alert*>> by_source(const std::vector<Alert>& alerts) {
  std::map<std::string, std::vector<const Alert*>> out;
  for (const Alert& alert : alerts) out[source_of(alert)].push_back(&alert);
  for (auto& [source, of] : out) {
    std::ranges::sort(of, [](const Alert* a, const Alert* b) { return came_before(*a, *b); });
  }
  return out;
}

std::uint32_t times_of(const std::map<std::string, UtcTime>& came, UtcTime now) {
  std::set<std::int64_t> times;
  for (const auto& [alert, at] : came) times.insert(at.ns);
  std::vector<UtcTime> out;
  for (const std::int64_t ns : times) out.push_back({ns});
  return chatter(std::move(out), now);
}

}  // namespace

std::string source_of(const Alert& alert) {
  const std::string whose = alert.robot.empty() ? "run " + alert.run : alert.robot;
  return whose + "/" + alert.capability + "/" + alert.cause;
}

std::uint32_t priority_of(Severity severity) {
  return severity == Severity::fatal ? 1 : severity == Severity::critical ? 2 : severity == Severity::urgent ? 3 : 4;
}

bool is_open(const Alert& alert) {
  return alert.state == AlertState::open || alert.state == AlertState::expired || alert.state == AlertState::releasing;
}

void AlarmDesk::replace(const std::vector<Acknowledgement>& rows) {
  acknowledged_.clear();
  for (const Acknowledgement& one : rows) acknowledged_[one.alert] = one;
  put_changes(acknowledged_changes_, acknowledged_);
}

void AlarmDesk::replace(const std::vector<Shelf>& rows) {
  shelves_.clear();
  for (const Shelf& one : rows) shelves_[one.source] = one;
  put_changes(shelf_changes_, shelves_);
}

bool AlarmDesk::has(const Acknowledgement& one) const {
  const auto at = acknowledged_.find(one.alert);
  return at != acknowledged_.end() && at->second.severity >= one.severity;
}

void AlarmDesk::see(const std::vector<Alert>& alerts, UtcTime now) {
  const std::map<std::string, Known> before = std::exchange(known_, {});
  std::map<std::string, UtcTime> known_comings;
  for (const auto& [alert, known] : before) known_comings[alert] = known.came;
  for (const auto& [source, of] : by_source(alerts)) {
    const std::map<std::string, UtcTime> came = comings_of(of, known_comings);
    const std::uint32_t times = times_of(came, now);
    const auto last_open = std::find_if(of.rbegin(), of.rend(), [](const Alert* one) { return is_open(*one); });
    for (const Alert* alert : of) {
      const bool is_repeat = !is_open(*alert) || alert == *last_open;
      known_[alert->id] = {alert->severity, source, is_repeat ? times : 0, first_of(*alert, alerts),
                           came.at(alert->id)};
    }
  }
  take_over(alerts, before, now);
}

bool AlarmDesk::is_over(const Acknowledgement& one, const std::map<std::string, Known>& before, UtcTime now) const {
  if (const auto at = known_.find(one.alert); at != known_.end()) return at->second.severity > one.severity;
  return before.contains(one.alert) || one.at + kForgottenAfter < now;
}

/// Acknowledgements of alerts that are gone go; one that chatters keeps that of its last time.
void AlarmDesk::take_over(const std::vector<Alert>& alerts, const std::map<std::string, Known>& before, UtcTime now) {
  std::map<std::string, Acknowledgement> seen;  // by source: the newest
  std::vector<std::string> over;
  for (const auto& [alert, one] : acknowledged_) {
    if (is_over(one, before, now)) over.push_back(alert);
    const auto is = known_.find(alert);
    const auto was = before.find(alert);
    const std::string source = is != known_.end() ? is->second.source : was != before.end() ? was->second.source : "";
    if (Acknowledgement& last = seen[source]; last.at <= one.at) last = one;
  }
  for (const std::string& alert : over) drop_acknowledged(alert);
  for (const Alert& alert : alerts) {
    const Known& known = known_[alert.id];
    const auto last = seen.find(known.source);
    const bool is_new = !before.contains(alert.id) && !acknowledged_.contains(alert.id);
    if (!is_new || known.times == 0 || last == seen.end() || alert.severity > last->second.severity) continue;
    put({alert.id, last->second.by, last->second.at, alert.severity});
  }
}

void AlarmDesk::tick(UtcTime steady) {
  for (auto at = shelves_.begin(); at != shelves_.end();) {
    if (steady < at->second.until) {
      ++at;
      continue;
    }
    shelf_changes_.drop(at->first);
    ended_.push_back(std::move(at->second));
    at = shelves_.erase(at);
  }
}

void AlarmDesk::move(const SteadyStep& step) {
  for (auto& [source, shelf] : shelves_) {
    if (!step.moves(shelf.at)) continue;
    shelf.at = step.moved(shelf.at);
    shelf.until = shelf.until + step.by;
    shelf_changes_.put(source, shelf);
  }
}

Result<const AlarmDesk::Known*> AlarmDesk::find(const std::string& alert) const {
  const auto at = known_.find(alert);
  if (at != known_.end()) return &at->second;
  return fail(Errc::unknown_target, "there is no such alert", "GET /api/v1/alerts");
}

Status AlarmDesk::acknowledge(const std::string& alert, const std::string& who, UtcTime now) {
  const auto known = find(alert);
  if (!known) return known.error();
  if (!acknowledged_.contains(alert)) put({alert, who, now, (*known)->severity});
  return Done{};
}

Status AlarmDesk::shelve(const std::string& alert, const std::string& who, Duration time, const std::string& why,
                         UtcTime steady) {
  const auto known = find(alert);
  if (!known) return known.error();
  if (time < kShortestShelf || time > kLongestShelf) {
    return fail(Errc::bad_value, "minutes: is out of range",
                "use 1 to 480: nothing is shelved for longer than a shift");
  }
  if (why.empty() || why.size() > kMaxShelfReason) {
    return fail(Errc::bad_value, "reason: has no text, or too much", "say in 255 bytes why it may wait");
  }
  const std::string& source = (*known)->source;
  if (!shelves_.contains(source) && shelves_.size() == kMaxShelves) {
    return fail(Errc::queue_full, std::to_string(kMaxShelves) + " alarms are shelved", "unshelve some first");
  }
  Shelf shelf{source, who, steady, steady + time, why};
  shelf_changes_.put(source, shelf);
  shelves_[source] = std::move(shelf);
  return Done{};
}

Status AlarmDesk::unshelve(const std::string& alert) {
  const auto known = find(alert);
  if (!known) return known.error();
  if (shelves_.erase((*known)->source) == 0) return fail(Errc::conflict, "it is not shelved", "there is nothing to do");
  shelf_changes_.drop((*known)->source);
  return Done{};
}

Alarm AlarmDesk::of(const std::string& alert) const {
  Alarm out;
  const auto at = known_.find(alert);
  if (at == known_.end()) return out;
  const Known& known = at->second;
  out.priority = priority_of(known.severity);
  out.source = known.source;
  out.chatters = known.times > 0;
  out.times = std::max<std::uint32_t>(known.times, 1);
  out.first = known.first;
  if (const auto one = acknowledged_.find(alert); one != acknowledged_.end()) {
    out.acknowledged_by = one->second.by;
    out.acknowledged = one->second.at;
  }
  if (const auto one = shelves_.find(known.source); one != shelves_.end()) {
    out.shelved_by = one->second.by;
    out.shelved_why = one->second.why;
    out.shelved = one->second.at;
    out.shelved_until = one->second.until;
  }
  return out;
}

void AlarmDesk::put(Acknowledgement one) {
  acknowledged_changes_.put(one.alert, one);
  acknowledged_[one.alert] = std::move(one);
}

void AlarmDesk::drop_acknowledged(const std::string& alert) {
  acknowledged_.erase(alert);
  acknowledged_changes_.drop(alert);
}

}  // namespace trb::gateway
