#include "services/resilience/core/proposals.hpp"

#include <algorithm>
#include <cmath>

#include "common/ranking/ranking.hpp"
#include "services/resilience/core/robot_state.hpp"
#include "services/resilience/core/shortlist.hpp"

namespace trb::resilience {
namespace {

constexpr Duration kOld = std::chrono::seconds(30);
constexpr std::size_t kMaxParts = 256;

/// A criterion's values of the candidates, in their order; what nobody knows is the mean of the others.
struct Column {
  std::string name;
  std::string unit;
  Direction direction{};
  double weight = 0;
  std::vector<double> values = {};
};

struct Ranked {
  std::string robot;
  double score = 0;
  std::vector<CriterionPart> parts;
  std::string note;
};

/// The first place among the parameters that the robot's skills take as places.
std::optional<HallPoint> place_of(const RobotRecord& robot, const std::vector<TaskNeed>& needs,
                                  const HallPlaces& places) {
  for (const TaskNeed& need : needs) {
    const SkillInfo* skill = find_skill(robot, need.skill);
    if (skill == nullptr) continue;
    for (const auto& [name, value] : need.arguments) {
      const auto info = std::ranges::find(skill->parameters, name, &ParameterInfo::name);
      if (info == skill->parameters.end() || info->type != "place" || !value.is_text()) continue;
      const auto place = places.find(value.text());
      if (place != places.end()) return place->second;
    }
  }
  return std::nullopt;
}

class Ranker {
 public:
  Ranker(const Fleet& fleet, const std::vector<TaskNeed>& needs, const HallPlaces& places,
         const ReplacementWeights& weights, UtcTime now)
      : fleet_(fleet), needs_(needs), places_(places), weights_(weights), now_(now) {}

  /// Best first, `most` at most; their scores sum to 1.
  std::vector<Ranked> rank(std::vector<std::string> robots, std::size_t most) {
    if (robots.empty()) return {};
    place_ = place_of(*fleet_.find(robots.front()), needs_, places_);
    robots_ = nearest(std::move(robots), most);
    notes_.assign(robots_.size(), "");
    fill_columns();
    return explain();
  }

 private:
  /// Only so many are ranked in full.
  std::vector<std::string> nearest(std::vector<std::string> robots, std::size_t most) const {
    if (robots.size() <= most) return robots;
    std::vector<RobotNumber> numbers;
    for (const std::string& id : robots) numbers.push_back(*fleet_.index().find(id));
    const Weights weights{weights_.battery, place_ ? weights_.distance : 0, weights_.availability};
    std::vector<std::string> out;
    for (const Scored& one : shortlist(fleet_.index(), numbers, weights, place_.value_or(HallPoint{}), most)) {
      out.push_back(fleet_.index().id_of(one.robot));
    }
    std::sort(out.begin(), out.end());
    return out;
  }

  void note(std::size_t robot, const std::string& text) { notes_[robot] += (notes_[robot].empty() ? "" : "; ") + text; }

  void note_age(std::size_t robot, const std::string& what, UtcTime at) {
    const Duration age{now_.ns - at.ns};
    if (age > kOld) note(robot, what + " is " + std::to_string(age / std::chrono::seconds(1)) + " s old");
  }

  double charge(std::size_t robot) {
    const auto told = charge_of(*fleet_.find(robots_[robot]));
    if (!told) return kUnknown;
    note_age(robot, "battery", told->at);
    return told->is;
  }

  double distance(std::size_t robot) {
    const RobotRecord& record = *fleet_.find(robots_[robot]);
    const auto told = position_of(record);
    if (!told) return kUnknown;
    if (told->at != record.profile.at) note_age(robot, "position", told->at);
    return std::hypot(told->is.x - place_->x, told->is.y - place_->y);
  }

  void add(Column column) {
    double sum = 0;
    double known = 0;
    for (const double value : column.values) {
      if (std::isnan(value)) continue;
      sum += value;
      known += 1;
    }
    for (std::size_t i = 0; i < column.values.size(); ++i) {
      if (!std::isnan(column.values[i])) continue;
      column.values[i] = known > 0 ? sum / known : 0;
      note(i, column.name + " is not known" + (known > 0 ? ", taken as the others' mean" : ""));
    }
    columns_.push_back(std::move(column));
  }

  void fill_columns() {
    Column battery{"battery", "%", Direction::benefit, weights_.battery};
    Column way{"distance", "m", Direction::cost, weights_.distance};
    Column availability{"availability", "", Direction::benefit, weights_.availability};
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      battery.values.push_back(charge(i));
      if (place_) way.values.push_back(distance(i));
      availability.values.push_back(resilience::availability(*fleet_.find(robots_[i])));
    }
    add(std::move(battery));
    if (place_) add(std::move(way));
    add(std::move(availability));
    // Without a place the way counts nothing; if that was all that counts, all count alike.
    double sum = 0;
    for (const Column& column : columns_) sum += column.weight;
    for (Column& column : columns_)
      column.weight = sum > 0 ? column.weight / sum : 1.0 / static_cast<double>(columns_.size());
  }

  [[nodiscard]] RankingProblem problem() const {
    RankingProblem out;
    out.goal = "replace";
    out.alternatives = robots_;
    out.options.sensitivity = false;
    for (const Column& column : columns_) {
      Criterion criterion{column.name};
      criterion.weight = column.weight;
      criterion.direction = column.direction;
      criterion.values = column.values;
      if (column.direction == Direction::cost) {
        for (double& value : criterion.values) value += kWayStart;
      }
      out.criteria.push_back(std::move(criterion));
    }
    return out;
  }

  std::vector<Ranked> explain() const {
    std::vector<Ranked> out;
    const auto answer = trb::rank(problem());
    if (!answer) {  // cannot be: names and values are the own ones
      for (const std::string& robot : robots_) out.push_back({robot, 0, {}, "not ranked: " + answer.error().what});
      return out;
    }
    for (const RankedAlternative& one : answer->ranking) {
      const auto at = static_cast<std::size_t>(std::ranges::find(robots_, one.id) - robots_.begin());
      Ranked ranked{one.id, one.score, {}, notes_[at]};
      for (std::size_t i = 0; i < columns_.size(); ++i) {
        const Column& column = columns_[i];
        ranked.parts.push_back({column.name, column.values[at], column.unit, column.weight, one.contributions[i]});
      }
      out.push_back(std::move(ranked));
    }
    return out;
  }

  const Fleet& fleet_;
  const std::vector<TaskNeed>& needs_;
  const HallPlaces& places_;
  const ReplacementWeights& weights_;
  UtcTime now_;
  std::optional<HallPoint> place_;
  std::vector<std::string> robots_;
  std::vector<std::string> notes_;
  std::vector<Column> columns_;
};

Proposal alone(const Ranked& ranked, const std::vector<TaskNeed>& needs) {
  Proposal out{ranked.robot, {}, ranked.score, ranked.parts, cut_utf8(ranked.note, 512)};
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

Ways find_ways(const Fleet& fleet, const Needs& needs, const HallPlaces& places, const ReplacementWeights& weights,
               UtcTime now) {
  Ways out;
  const Candidates candidates = find_candidates(fleet, needs);
  for (const Unsuitable& one : candidates.unsuitable) {
    if (out.unfit.size() < kMaxUnfit) out.unfit.push_back({one.robot, cut_utf8(one.why, 255)});
  }
  for (const Ranked& ranked : Ranker(fleet, needs.tasks, places, weights, now).rank(candidates.robots, kMaxProposals)) {
    out.proposals.push_back(alone(ranked, needs.tasks));
  }
  if (!candidates.robots.empty() || !candidates.cover()) return out;
  Proposal shared;
  for (std::size_t i = 0; i < needs.tasks.size(); ++i) {
    const std::vector<TaskNeed> one{needs.tasks[i]};
    const Ranked best =
        Ranker(fleet, one, places, weights, now).rank(candidates.by_task[i].robots, kMaxProposals).front();
    shared.tasks.push_back({one.front().task, best.robot});
    shared.score += best.score / static_cast<double>(needs.tasks.size());
    for (const CriterionPart& part : best.parts) {
      if (shared.parts.size() < kMaxParts) shared.parts.push_back(part);
    }
    if (!best.note.empty()) shared.note += (shared.note.empty() ? "" : "; ") + best.robot + ": " + best.note;
  }
  shared.note = cut_utf8(shared.note, 512);
  out.proposals.push_back(std::move(shared));
  return out;
}

}  // namespace trb::resilience
