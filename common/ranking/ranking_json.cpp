#include "common/ranking/ranking_json.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "common/base/number_text.hpp"
#include "proto/value_words.hpp"

namespace trb {
namespace {

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
constexpr std::size_t kMostPairs = kMostJudged * kMostJudged;

std::string item(const std::string& path, std::size_t index) {
  return path + "[" + std::to_string(index) + "]";
}

std::string below(const std::string& path, std::string_view key) {
  return path.empty() ? std::string(key) : path + "." + std::string(key);
}

/// "3", "0.5" or "1/2".
std::optional<double> fraction(std::string_view text) {
  const auto slash = text.find('/');
  const auto over = parse_number<double>(text.substr(0, slash));
  const auto under = slash == std::string_view::npos ? 1.0 : parse_number<double>(text.substr(slash + 1));
  if (!over || !under || *under == 0) return std::nullopt;
  return *over / *under;
}

/// Reads the document key by key; the first error is kept, and what is read after it is not used.
class Reader {
 public:
  Result<RankingProblem> read(const Value& json) {
    RankingProblem out;
    const auto* members = object(
        json, "",
        {"goal", "description", "criteria", "judgments", "people", "alternatives", "alternative_judgments", "options"});
    if (members != nullptr) {
      out.goal = text(require(json, "goal", "goal"), "goal");
      read_criteria(require(json, "criteria", "criteria"), "criteria", out.criteria);
      read_alternatives(require(json, "alternatives", "alternatives"), out);
      read_people(json, out.people);
      if (const Value* options = json.find("options")) read_options(*options, out.options);
    }
    if (error_.code != Errc::ok) return error_;
    return out;
  }

 private:
  using Keys = std::vector<std::string>;
  using Columns = std::map<std::string, std::vector<double>*>;

  void refuse(Errc code, const std::string& what, const std::string& hint) {
    if (error_.code == Errc::ok) error_ = fail(code, what, hint);
  }

  void wrong_kind(const Value& value, const std::string& path, const std::string& wanted) {
    refuse(Errc::bad_value, (path.empty() ? "the document" : path) + " is " + in_words(value),
           "write " + wanted + " there");
  }

  /// nullptr if it is not an object, or has another key.
  const Value::Object* object(const Value& value, const std::string& path, const Keys& keys) {
    if (!value.is_object()) {
      wrong_kind(value, path, "an object, { \"KEY\": VALUE, … },");
      return nullptr;
    }
    for (const auto& [key, ignored] : value.object()) {
      if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
      refuse(Errc::unknown_key, below(path, key) + " is no key that is known here", "use " + quoted_names(keys));
      return nullptr;
    }
    return &value.object();
  }

  /// An empty list if it is not a list, or too long.
  const Value::List& list(const Value& value, const std::string& path, std::size_t most) {
    static const Value::List kEmpty;
    if (!value.is_list()) {
      wrong_kind(value, path, "a list, [ … ],");
      return kEmpty;
    }
    if (value.list().size() <= most) return value.list();
    refuse(Errc::too_large, path + ": " + std::to_string(value.list().size()) + " are too many",
           "keep it to " + std::to_string(most));
    return kEmpty;
  }

  const Value& require(const Value& value, std::string_view key, const std::string& path) {
    static const Value kNothing{nullptr};
    const Value* found = value.find(key);
    if (found == nullptr) refuse(Errc::missing, path + " is missing", "add \"" + std::string(key) + "\"");
    return found == nullptr ? kNothing : *found;
  }

  std::string text(const Value& value, const std::string& path) {
    if (!value.is_text()) {
      wrong_kind(value, path, "a text, in quotes,");
      return {};
    }
    if (value.text().size() <= kLongestName) return value.text();
    refuse(Errc::too_large, path + " is " + std::to_string(value.text().size()) + " bytes long",
           "keep it to " + std::to_string(kLongestName));
    return {};
  }

  double number(const Value& value, const std::string& path) {
    if (value.is_number()) return value.number();
    wrong_kind(value, path, "a number, without quotes,");
    return 0;
  }

  template <NamedEnum E>
  E one_of(const Value& value, const std::string& path) {
    constexpr auto kNames = enum_names(E{});
    const auto at = std::find(kNames.begin(), kNames.end(), text(value, path));
    if (at != kNames.end()) return static_cast<E>(at - kNames.begin());
    refuse(Errc::bad_value, path + " is not known", "use " + quoted_names({kNames.begin(), kNames.end()}));
    return E{};
  }

  void read_criteria(const Value& value, const std::string& path, std::vector<Criterion>& out) {
    const Value::List& items = list(value, path, kMostChildren);
    out.reserve(items.size());  // columns_ points into it
    for (std::size_t i = 0; i < items.size(); ++i) {
      out.push_back({});
      read_criterion(items[i], item(path, i), out.back());
    }
  }

  void read_criterion(const Value& value, const std::string& path, Criterion& out) {
    if (object(value, path, {"name", "direction", "unit", "weight", "children"}) == nullptr) return;
    out.name = text(require(value, "name", below(path, "name")), below(path, "name"));
    if (const Value* unit = value.find("unit")) out.unit = text(*unit, below(path, "unit"));
    if (const Value* weight = value.find("weight")) out.weight = number(*weight, below(path, "weight"));
    if (const Value* found = value.find("direction"))
      out.direction = one_of<Direction>(*found, below(path, "direction"));
    if (const Value* children = value.find("children")) {
      read_criteria(*children, below(path, "children"), out.children);
    }
    if (out.children.empty()) columns_[out.name] = &out.values;
  }

  void read_alternatives(const Value& value, RankingProblem& out) {
    const Value::List& items = list(value, "alternatives", kMostAlternatives);
    if (items.size() * columns_.size() > kMostValues) {
      refuse(Errc::too_large, "alternatives x criteria are more than " + std::to_string(kMostValues), "rank fewer");
    }
    for (std::size_t i = 0; i < items.size() && error_.code == Errc::ok; ++i) {
      const std::string path = item("alternatives", i);
      if (object(items[i], path, {"id", "values"}) == nullptr) return;
      out.alternatives.push_back(text(require(items[i], "id", below(path, "id")), below(path, "id")));
      if (const Value* values = items[i].find("values")) read_values(*values, below(path, "values"), i, items.size());
    }
  }

  void read_values(const Value& values, const std::string& path, std::size_t index, std::size_t count) {
    if (!values.is_object()) return wrong_kind(values, path, "an object, { \"CRITERION\": NUMBER, … },");
    for (const auto& [name, value] : values.object()) {
      const auto column = columns_.find(name);
      if (column == columns_.end()) {
        Keys names;
        for (const auto& [known, ignored] : columns_) names.push_back(known);
        return refuse(Errc::unknown_key, below(path, name) + ": there is no such criterion without children",
                      "use " + quoted_names(names));
      }
      std::vector<double>& out = *column->second;
      if (out.empty()) out.assign(count, kNone);
      out[index] = number(value, below(path, name));
    }
  }

  void read_people(const Value& json, std::vector<Person>& out) {
    const Value* people = json.find("people");
    const bool alone = json.find("judgments") != nullptr || json.find("alternative_judgments") != nullptr;
    if (people == nullptr && alone) {
      out.push_back({});
      read_judgments(json, "", out.back());
    }
    if (people == nullptr) return;
    if (alone) {
      refuse(Errc::bad_value, "people: there are also judgments that are nobody's", "give them to one of the people");
    }
    const Value::List& items = list(*people, "people", kMostPeople);
    for (std::size_t i = 0; i < items.size(); ++i) {
      const std::string path = item("people", i);
      if (object(items[i], path, {"name", "weight", "judgments", "alternative_judgments"}) == nullptr) return;
      out.push_back({});
      if (const Value* name = items[i].find("name")) out.back().name = text(*name, below(path, "name"));
      if (const Value* weight = items[i].find("weight")) out.back().weight = number(*weight, below(path, "weight"));
      read_judgments(items[i], path, out.back());
    }
  }

  void read_judgments(const Value& json, const std::string& path, Person& out) {
    read_lists(json.find("judgments"), below(path, "judgments"), out.judgments);
    read_lists(json.find("alternative_judgments"), below(path, "alternative_judgments"), out.alternative_judgments);
  }

  void read_lists(const Value* value, const std::string& path, std::vector<NodeJudgments>& out) {
    if (value == nullptr) return;
    if (!value->is_object()) return wrong_kind(*value, path, R"(an object, { "NODE": [["A", "B", 3], …], … },)");
    if (value->object().size() > kMostCriteria) {
      return refuse(Errc::too_large, path + " has more lists than there may be criteria", "leave some out");
    }
    for (const auto& [node, judgments] : value->object()) {
      out.push_back({node, {}});
      const std::string at = below(path, node);
      const Value::List& items = list(judgments, at, kMostPairs);
      for (std::size_t i = 0; i < items.size(); ++i) out.back().list.push_back(judgment(items[i], item(at, i)));
    }
  }

  Judgment judgment(const Value& value, const std::string& path) {
    if (!value.is_list() || value.list().size() != 3) {
      refuse(Errc::bad_value, path + " is no judgment", R"(write ["A", "B", 3]: A counts three times as much as B)");
      return {};
    }
    const Value::List& parts = value.list();
    return {text(parts[0], item(path, 0)), text(parts[1], item(path, 1)), times(parts[2], item(path, 2))};
  }

  double times(const Value& value, const std::string& path) {
    if (!value.is_text()) return number(value, path);
    const auto found = fraction(value.text());
    if (!found) refuse(Errc::bad_value, path + " is no number and no fraction", R"(write 3, or a text like "1/3")");
    return found.value_or(1);
  }

  void read_options(const Value& value, RankingOptions& out) {
    if (object(value, "options", {"method", "max_ratio"}) == nullptr) return;
    if (const Value* method = value.find("method")) out.method = one_of<WeightMethod>(*method, "options.method");
    if (const Value* ratio = value.find("max_ratio")) out.max_ratio = number(*ratio, "options.max_ratio");
  }

  Error error_;
  Columns columns_;  ///< of each criterion without children
};

Value of(Value::Object object) {
  return Value{std::move(object)};
}

Value criteria_value(const RankingAnswer& answer) {
  Value::Object out;
  for (const CriterionWeight& one : answer.criteria) {
    out.emplace_back(one.name, of({{"weight", Value{one.local}}, {"global", Value{one.global}}}));
  }
  return of(std::move(out));
}

Value consistency_value(const RankingAnswer& answer) {
  Value::Object out;
  for (const NodeConsistency& one : answer.consistency) {
    out.emplace_back(
        one.node, of({{"lambda_max", Value{one.of.lambda_max}}, {"ci", Value{one.of.ci}}, {"cr", Value{one.of.cr}}}));
  }
  return of(std::move(out));
}

Value alternative_value(const RankedAlternative& one, const std::vector<std::string>& leaves) {
  Value::Object contributions;
  for (std::size_t i = 0; i < leaves.size(); ++i) contributions.emplace_back(leaves[i], Value{one.contributions[i]});
  return of({{"id", Value{one.id}}, {"score", Value{one.score}}, {"contributions", of(std::move(contributions))}});
}

Value sensitivity_value(const Sensitivity& one) {
  Value::List changes;
  for (const WinnerChange& change : one.changes) {
    changes.push_back(of({{"weight", Value{change.weight}}, {"winner", Value{change.winner}}}));
  }
  return of(
      {{"criterion", Value{one.criterion}}, {"weight", Value{one.weight}}, {"changes", Value{std::move(changes)}}});
}

}  // namespace

Result<RankingProblem> read_ranking(const Value& json) {
  return Reader().read(json);
}

Value ranking_value(const RankingAnswer& answer) {
  Value::List ranking;
  for (const RankedAlternative& one : answer.ranking) ranking.push_back(alternative_value(one, answer.leaves));
  Value::List sensitivity;
  for (const Sensitivity& one : answer.sensitivity) sensitivity.push_back(sensitivity_value(one));
  return of({{"criteria", criteria_value(answer)},
             {"consistency", consistency_value(answer)},
             {"ranking", Value{std::move(ranking)}},
             {"sensitivity", Value{std::move(sensitivity)}}});
}

}  // namespace trb
