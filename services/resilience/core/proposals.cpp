#include "services/resilience/core/proposals.hpp"

#include <algorithm>

#include "proto/message.hpp"
#include "services/resilience/core/ranker.hpp"

namespace trb::resilience {
namespace {

constexpr std::size_t kMaxParts = 256;
constexpr std::size_t kMaxNote = 512;
constexpr std::size_t kMostNamed = kMaxDataSize / 2;  ///< bytes that all proposals' tasks and robots take

/// Each proposal names every task, and an alert's reader takes no more than a message has. So of a thousand tasks there
/// are fewer proposals; three at least, for a lead is measured against the second.
std::size_t most_proposals(const std::vector<TaskNeed>& needs, const std::vector<std::string>& robots) {
  constexpr std::size_t kHeads = 5;  // msgpack's, of a task and its robot
  std::size_t longest = 0;
  for (const std::string& robot : robots) longest = std::max(longest, robot.size());
  std::size_t size = 0;
  for (const TaskNeed& need : needs) size += kHeads + need.task.size() + longest;
  return std::clamp<std::size_t>(kMostNamed / std::max<std::size_t>(size, 1), 1, kMaxProposals);
}

Proposal alone(const Ranked& ranked, const std::vector<TaskNeed>& needs) {
  Proposal out{ranked.robot, {}, ranked.score, ranked.parts, cut_utf8(ranked.note, kMaxNote), ranked.merit};
  for (const TaskNeed& need : needs) out.tasks.push_back({need.task, ranked.robot});
  return out;
}

}  // namespace

Result<Needs> needs_of(const WatchedRun& run, const std::vector<std::size_t>& tasks, const std::string& robot) {
  Needs out;
  out.except.push_back(robot);
  for (const std::size_t index : tasks) {
    const Task& task = run.start->scenario.tasks[index];
    auto need = need_of(task);
    if (!need) return need.error();
    for (const ValueFrom& value : task.values) {
      if (std::ranges::find(need->later, value.parameter) == need->later.end()) need->later.push_back(value.parameter);
    }
    need->tried = run.view->tasks[index].failed_by;
    out.tasks.push_back(std::move(*need));
  }
  return out;
}

namespace {

/// Selects the robots that no bound excludes; the others are listed, and may be asked for newer values.
class Bounds {
 public:
  Bounds(const Fleet& fleet, const HallPlaces& places, const Criteria& criteria, Ways& out)
      : fleet_(fleet), places_(places), criteria_(criteria), out_(out) {}

  std::vector<std::string> within(const std::vector<std::string>& robots, const std::vector<TaskNeed>& needs,
                                  const std::string& of) {
    if (robots.empty() || !has_bounds(criteria_)) return robots;
    const auto place = place_of(*fleet_.find(robots.front()), needs, places_);
    std::vector<std::string> kept;
    for (const std::string& id : robots) {
      const std::string why = why_out(criteria_, needs, *fleet_.find(id), place);
      why.empty() ? kept.push_back(id) : add_unfit(id, why + of);
    }
    return kept;
  }

 private:
  void add_unfit(const std::string& id, const std::string& why) {
    const bool known = std::ranges::find(out_.bounded, id) != out_.bounded.end();
    if (known || out_.bounded.size() >= kMaxProposals) return;
    out_.bounded.push_back(id);
    if (out_.unfit.size() < kMaxUnfit) out_.unfit.push_back({id, cut_utf8(why, 255)});
  }

  const Fleet& fleet_;
  const HallPlaces& places_;
  const Criteria& criteria_;
  Ways& out_;
};

/// One part per criterion, if all robots together have too many parts: they still add up to the score.
std::vector<CriterionPart> summed(const std::vector<CriterionPart>& parts) {
  std::vector<CriterionPart> out;
  for (const CriterionPart& part : parts) {
    const auto at = std::ranges::find(out, part.criterion, &CriterionPart::criterion);
    if (at == out.end()) {
      out.push_back(part);
      out.back().robot.clear();
    } else {
      at->contribution += part.contribution;
    }
  }
  return out;
}

/// The best robot for each of the tasks; nothing: one task has none.
std::optional<Proposal> several(const Needs& needs, const std::vector<std::vector<std::string>>& by_task,
                                const Ranking& ranking) {
  Proposal out;
  const auto count = static_cast<double>(needs.tasks.size());
  for (std::size_t i = 0; i < needs.tasks.size(); ++i) {
    if (by_task[i].empty()) return std::nullopt;
    const std::vector<TaskNeed> one{needs.tasks[i]};
    const Ranked best = rank(ranking, one, by_task[i], kMaxProposals).front();
    out.tasks.push_back({one.front().task, best.robot});
    out.score += best.score / count;
    out.merit += best.merit / count;
    for (CriterionPart part : best.parts) {
      part.contribution /= count;
      out.parts.push_back(std::move(part));
    }
    if (!best.note.empty() && out.note.size() < kMaxNote) {
      out.note += (out.note.empty() ? "" : "; ") + best.robot + ": " + best.note;
    }
  }
  if (out.parts.size() > kMaxParts) out.parts = summed(out.parts);
  out.note = cut_utf8(out.note, kMaxNote);
  return out;
}

}  // namespace

Ways find_ways(const Fleet& fleet, const Needs& needs, const HallPlaces& places, const Criteria& criteria,
               UtcTime now) {
  Ways out;
  const Candidates candidates = find_candidates(fleet, needs);
  for (const Unsuitable& one : candidates.unsuitable) {
    if (out.unfit.size() < kMaxUnfit) out.unfit.push_back({one.robot, cut_utf8(one.why, 255)});
  }
  const Ranking ranking{fleet, places, criteria, now};
  Bounds bounds(fleet, places, criteria, out);
  const std::vector<std::string> robots = bounds.within(candidates.robots, needs.tasks, "");
  for (const Ranked& ranked : rank(ranking, needs.tasks, robots, most_proposals(needs.tasks, robots))) {
    out.proposals.push_back(alone(ranked, needs.tasks));
  }
  if (!robots.empty()) return out;
  std::vector<std::vector<std::string>> by_task;
  for (std::size_t i = 0; i < needs.tasks.size(); ++i) {
    const std::vector<TaskNeed> one{needs.tasks[i]};
    const std::vector<std::string> able =
        candidates.robots.empty() ? candidates.by_task[i].robots : find_able(fleet, one, needs.except);
    by_task.push_back(bounds.within(able, one, " (task " + one.front().task + ")"));
  }
  if (auto shared = several(needs, by_task, ranking)) out.proposals.push_back(std::move(*shared));
  return out;
}

}  // namespace trb::resilience
