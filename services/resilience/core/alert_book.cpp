#include "services/resilience/core/alert_book.hpp"

#include <algorithm>
#include <tuple>

#include "common/base/hex.hpp"
#include "common/security/keys.hpp"
#include "proto/body.hpp"
#include "proto/message.hpp"

namespace trb::resilience {
namespace {

constexpr std::size_t kIdBytes = 8;
constexpr std::size_t kMaxNamed = 8;

/// An answer is one message: with very many alerts lesser proposals are left out, and finally the oldest alerts.
void fit(AlertTable& table) {
  constexpr std::size_t kMost = kMaxDataSize - (384U << 10U);  // leaves room for lesser faults
  for (const std::size_t kept : {std::size_t{16}, std::size_t{4}, std::size_t{1}, std::size_t{0}}) {
    if (encode(table).size() <= kMost) return;
    for (Alert& alert : table.alerts) {
      alert.proposals.resize(std::min(alert.proposals.size(), kept));
      alert.unfit.resize(std::min(alert.unfit.size(), kept));
    }
  }
  while (encode(table).size() > kMost) table.alerts.resize(table.alerts.size() / 2);
}

bool earlier_of(const Alert* a, const Alert* b) {
  return std::tie(a->time, a->id) < std::tie(b->time, b->id);
}

}  // namespace

bool is_open(const Alert& alert) {
  return alert.state != AlertState::decided && alert.state != AlertState::closed;
}

void AlertBook::put(Alert alert) {
  drop(alert.id);
  Alert& kept = alerts_[alert.id];
  kept = std::move(alert);
  if (is_open(kept)) open_.insert(std::upper_bound(open_.begin(), open_.end(), &kept, earlier_of), &kept);
}

void AlertBook::drop(const std::string& id) {
  std::erase_if(open_, [&](const Alert* alert) { return alert->id == id; });
  alerts_.erase(id);
}

void AlertBook::follow() {
  std::erase_if(open_, [](const Alert* alert) { return !is_open(*alert); });
}

Alert* AlertBook::add(Alert alert, bool trusted) {
  if (!(alert.run.empty() ? has_room_for_lone(alert.robot) : has_room_of_run(alert, trusted))) return nullptr;
  do {
    const std::string of =
        alert.run + '\n' + alert.robot + '\n' + std::to_string(alert.time) + '\n' + std::to_string(++count_);
    alert.id = to_hex(digest(of).substr(0, kIdBytes));
  } while (alerts_.contains(alert.id));
  const std::string id = alert.id;
  put(std::move(alert));
  return find(id);
}

Alert* AlertBook::find(std::string_view id) {
  const auto at = alerts_.find(id);
  return at == alerts_.end() ? nullptr : &at->second;
}

Result<Alert*> AlertBook::choose(const std::string& beginning) {
  std::vector<Alert*> matches;
  for (auto& [id, alert] : alerts_) {
    if (id.starts_with(beginning)) matches.push_back(&alert);
  }
  if (matches.size() == 1 && !beginning.empty()) return matches.front();
  if (matches.empty() || beginning.empty()) {
    return fail(Errc::unknown_target, "no alert begins with '" + beginning + "'", "trb alert list names them");
  }
  std::string names;
  for (std::size_t i = 0; i < matches.size() && i < kMaxNamed; ++i) names += (i == 0 ? "" : ", ") + matches[i]->id;
  return fail(Errc::bad_value, "'" + beginning + "' is the beginning of several alerts: " + names,
              "give more of the id");
}

bool AlertBook::has_room_for_lone(const std::string& robot) {
  follow();
  std::size_t lone = 0;
  std::size_t own = 0;
  for (const Alert* alert : open_) {
    if (!alert->run.empty()) continue;
    ++lone;
    if (alert->robot == robot) ++own;
  }
  return open_.size() < kMaxOpen && lone < kMaxLone && own < kMaxLoneOfRobot;
}

std::string_view AlertBook::submitter_of(const std::string& run) const {
  return submitter_of_ ? submitter_of_(run) : std::string_view();
}

/// A robot's share is of one submitter's runs: another's do not use it up. Alerts of a trusted submitter's tasks whose
/// robot is yet to be chosen are nobody's share.
bool AlertBook::has_room_of_run(const Alert& fresh, bool trusted) {
  follow();
  if (open_.size() >= kMaxOpen) return false;
  if (trusted && fresh.robot.empty()) return true;
  const std::string_view submitter = submitter_of(fresh.run);
  const auto count = std::ranges::count_if(open_, [&](const Alert* alert) {
    const bool counts = !alert->run.empty() && (!trusted || alert->robot == fresh.robot);
    return counts && submitter_of(alert->run) == submitter;
  });
  return static_cast<std::size_t>(count) < (trusted ? kMaxOfRobot : kMaxOfSubmitter);
}

std::vector<Alert*> AlertBook::open() {
  follow();
  return open_;
}

AlertTable AlertBook::table(bool all) const {
  std::vector<const Alert*> chosen;
  for (const auto& [id, alert] : alerts_) {
    if (all || is_open(alert)) chosen.push_back(&alert);
  }
  std::sort(chosen.begin(), chosen.end(),
            [](const Alert* a, const Alert* b) { return is_open(*a) != is_open(*b) ? is_open(*a) : earlier_of(b, a); });
  if (chosen.size() > kMaxTable) chosen.resize(kMaxTable);
  std::sort(chosen.begin(), chosen.end(), [](const Alert* a, const Alert* b) { return earlier_of(b, a); });
  AlertTable out;
  for (const Alert* alert : chosen) out.alerts.push_back(*alert);
  fit(out);
  return out;
}

void AlertBook::prune() {
  follow();
  if (alerts_.size() - open_.size() <= kMaxDone) return;
  std::vector<Alert*> done;
  for (auto& [id, alert] : alerts_) {
    if (!is_open(alert)) done.push_back(&alert);
  }
  std::sort(done.begin(), done.end(), earlier_of);
  std::vector<std::string> old;
  for (std::size_t i = 0; i + kMaxDone < done.size(); ++i) old.push_back(done[i]->id);
  for (const std::string& id : old) alerts_.erase(id);
}

}  // namespace trb::resilience
