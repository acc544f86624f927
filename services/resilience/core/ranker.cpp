#include "services/resilience/core/ranker.hpp"

#include <algorithm>
#include <cmath>

#include "common/ranking/ranking.hpp"
#include "services/resilience/core/shortlist.hpp"

namespace trb::resilience {
namespace {

constexpr Duration kOld = std::chrono::seconds(30);

/// The candidates' values of one criterion, in their order; an unknown value is the mean of the others.
struct Column {
  const ReplacementCriterion* of = nullptr;
  double weight = 0;
  std::vector<double> values{};
  bool known = true;  ///< of at least one candidate
};

bool is_own(const ReplacementCriterion& criterion) {
  return criterion.from > CriterionSource::availability;
}

class Ranker {
 public:
  Ranker(const Ranking& of, const std::vector<TaskNeed>& needs) : of_(of), needs_(needs) {}

  std::vector<Ranked> rank(std::vector<std::string> robots, std::size_t most) {
    if (robots.empty()) return {};
    measure_all(std::move(robots), most);
    return explain();
  }

  std::vector<WeightFlip> flips(std::vector<std::string> robots) {
    if (robots.size() < 2) return {};
    const std::size_t count = robots.size();
    measure_all(std::move(robots), count);
    RankingProblem asked = problem();
    asked.options.sensitivity = true;
    std::vector<WeightFlip> out;
    const auto answer = trb::rank(asked);
    if (!answer) return out;  // impossible, as below
    for (const Sensitivity& one : answer->sensitivity) {
      for (const WinnerChange& change : one.changes) out.push_back({one.criterion, change.weight, change.winner});
    }
    return out;
  }

 private:
  void measure_all(std::vector<std::string> robots, std::size_t most) {
    const RobotRecord& first = *of_.fleet.find(robots.front());
    place_ = place_of(first, needs_, of_.places);
    for (const ReplacementCriterion& one : of_.criteria) {
      if (counts(one, needs_, first, place_)) columns_.push_back({&one, one.weight});
    }
    weigh();
    robots_ = best_of(std::move(robots), most);
    notes_.assign(robots_.size(), "");
    for (Column& column : columns_) fill(column);
  }

  /// Without a place the distance has no weight; if it was the only criterion, all are equal.
  void weigh() {
    double sum = 0;
    for (const Column& column : columns_) sum += column.weight;
    for (Column& column : columns_) {
      column.weight = sum > 0 ? column.weight / sum : 1.0 / static_cast<double>(columns_.size());
    }
  }

  /// Only this many are ranked in full.
  [[nodiscard]] std::vector<std::string> best_of(std::vector<std::string> robots, std::size_t most) const {
    if (robots.size() <= most) return robots;
    const bool own =
        std::ranges::any_of(columns_, [](const Column& column) { return is_own(*column.of) && column.weight > 0; });
    std::vector<std::string> out = own ? most_worth(robots, most) : nearest(robots, most);
    std::sort(out.begin(), out.end());
    return out;
  }

  [[nodiscard]] double weight_of(CriterionSource source) const {
    for (const Column& column : columns_) {
      if (column.of->from == source) return column.weight;
    }
    return 0;
  }

  [[nodiscard]] std::vector<std::string> nearest(const std::vector<std::string>& robots, std::size_t most) const {
    const FleetIndex& index = of_.fleet.index();
    std::vector<RobotNumber> numbers;
    for (const std::string& id : robots) numbers.push_back(*index.find(id));
    const Weights weights{weight_of(CriterionSource::charge), weight_of(CriterionSource::distance),
                          weight_of(CriterionSource::availability)};
    std::vector<std::string> out;
    for (const Scored& one : shortlist(index, numbers, weights, place_.value_or(HallPoint{}), most)) {
      out.push_back(index.id_of(one.robot));
    }
    return out;
  }

  [[nodiscard]] std::vector<std::string> most_worth(const std::vector<std::string>& robots, std::size_t most) const {
    std::vector<std::pair<double, std::string>> worths;
    for (const std::string& id : robots) {
      double sum = 0;
      for (const Column& column : columns_) {
        sum += column.weight * worth(*column.of, measure(*column.of, *of_.fleet.find(id), place_).value);
      }
      worths.emplace_back(-sum, id);
    }
    std::sort(worths.begin(), worths.end());
    worths.resize(most);
    std::vector<std::string> out;
    for (auto& [sum, id] : worths) out.push_back(std::move(id));
    return out;
  }

  void note(std::size_t robot, const std::string& text) { notes_[robot] += (notes_[robot].empty() ? "" : "; ") + text; }

  void note_age(std::size_t robot, const ReplacementCriterion& criterion, UtcTime at) {
    const Duration age{of_.now.ns - at.ns};
    const std::string what = criterion.from == CriterionSource::distance ? "position" : criterion.name;
    if (age < Duration{0}) return note(robot, what + " is of an unknown time: the clock was set back");
    if (age > kOld) note(robot, what + " is " + std::to_string(age / std::chrono::seconds(1)) + " s old");
  }

  void fill(Column& column) {
    double sum = 0;
    double known = 0;
    for (std::size_t i = 0; i < robots_.size(); ++i) {
      const Measured told = measure(*column.of, *of_.fleet.find(robots_[i]), place_);
      column.values.push_back(told.value);
      if (std::isnan(told.value)) continue;
      if (told.told) note_age(i, *column.of, *told.told);
      sum += told.value;
      known += 1;
    }
    column.known = known > 0;
    for (std::size_t i = 0; i < column.values.size(); ++i) {
      if (!std::isnan(column.values[i])) continue;
      column.values[i] = column.known ? sum / known : 0;
      note(i, column.of->name + " is not known" + (column.known ? ", taken as the others' mean" : ""));
    }
  }

  /// The paper's criteria are compared by their measured values; the operator's own, which may be negative, by their
  /// worth.
  [[nodiscard]] RankingProblem problem() const {
    RankingProblem out;
    out.goal = "replace";
    out.alternatives = robots_;
    out.options.sensitivity = false;
    for (const Column& column : columns_) {
      Criterion criterion{column.of->name};
      criterion.weight = column.weight;
      criterion.values = column.values;
      const bool way = column.of->from == CriterionSource::distance;
      criterion.direction = way ? Direction::cost : Direction::benefit;
      for (double& value : criterion.values) {
        if (way) value += kWayStart;
        if (is_own(*column.of)) value = worth(*column.of, value);
      }
      out.criteria.push_back(std::move(criterion));
    }
    return out;
  }

  [[nodiscard]] std::vector<Ranked> explain() const {
    std::vector<Ranked> out;
    const auto answer = trb::rank(problem());
    if (!answer) {  // impossible: names and values are this service's own
      for (const std::string& robot : robots_) out.push_back({robot, 0, 0, {}, "not ranked: " + answer.error().what});
      return out;
    }
    for (const RankedAlternative& one : answer->ranking) {
      const auto at = static_cast<std::size_t>(std::ranges::find(robots_, one.id) - robots_.begin());
      Ranked ranked{one.id, one.score, 0, {}, notes_[at]};
      for (std::size_t i = 0; i < columns_.size(); ++i) {
        const Column& column = columns_[i];
        ranked.parts.push_back(
            {column.of->name, column.values[at], column.of->unit, column.weight, one.contributions[i], one.id});
        if (column.known) ranked.merit += column.weight * worth(*column.of, column.values[at]);
      }
      out.push_back(std::move(ranked));
    }
    return out;
  }

  const Ranking& of_;
  const std::vector<TaskNeed>& needs_;
  std::optional<HallPoint> place_;
  std::vector<std::string> robots_;
  std::vector<std::string> notes_;
  std::vector<Column> columns_;
};

}  // namespace

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

std::vector<Ranked> rank(const Ranking& of, const std::vector<TaskNeed>& needs, std::vector<std::string> robots,
                         std::size_t most) {
  return Ranker(of, needs).rank(std::move(robots), most);
}

std::vector<WeightFlip> weight_flips(const Ranking& of, const std::vector<TaskNeed>& needs,
                                     std::vector<std::string> robots) {
  return Ranker(of, needs).flips(std::move(robots));
}

}  // namespace trb::resilience
