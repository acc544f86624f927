#include "common/scenario/parameters.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>

#include "common/base/words.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "proto/value_words.hpp"

namespace trb {
namespace {

constexpr double kOpen = std::numeric_limits<double>::max();

std::string short_text(double number) {
  char out[32];
  std::snprintf(out, sizeof out, "%.6g", number);
  return out;
}

bool in_range(const ParameterInfo& info, const Value& value) {
  if (!std::isfinite(value.number())) return false;
  if (info.range.size() != 2) return true;
  return value.number() >= info.range[0] && value.number() <= info.range[1];
}

Misfit of_numbers(const ParameterInfo& info, const Value& value) {
  const auto is_number = [](const Value& item) { return item.is_number(); };
  if (!value.is_list() || !std::all_of(value.list().begin(), value.list().end(), is_number)) return Misfit::type;
  if (info.count != 0 && value.list().size() != info.count) return Misfit::count;
  const auto fits = [&](const Value& item) { return in_range(info, item); };
  return std::all_of(value.list().begin(), value.list().end(), fits) ? Misfit::none : Misfit::range;
}

std::string range_text(const ParameterInfo& info) {
  if (info.range.size() != 2) return {};
  const bool low = info.range[0] > -kOpen;
  const bool high = info.range[1] < kOpen;
  if (low && high) return " from " + short_text(info.range[0]) + " to " + short_text(info.range[1]);
  if (low) return " from " + short_text(info.range[0]) + " on";
  return high ? " up to " + short_text(info.range[1]) : "";
}

/// The first number that is out of range.
double outside(const ParameterInfo& info, const Value& value) {
  if (!value.is_list()) return value.number();
  const auto& items = value.list();
  return std::find_if(items.begin(), items.end(), [&](const Value& item) { return !in_range(info, item); })->number();
}

std::string outside_text(const ParameterInfo& info, double number) {
  if (!std::isfinite(number)) return "is no finite number";
  const bool is_under = number < info.range[0];
  const std::string unit = info.unit.empty() ? "" : " " + info.unit;
  return short_text(number) + (is_under ? " is under " : " is over ") + short_text(info.range[is_under ? 0 : 1]) + unit;
}

std::string type_text(const std::string& type) {
  if (type == "integer") return "a whole number";
  if (type == "numbers") return "a list of numbers";
  return type == "bool" ? "true or false" : "a " + type;
}

}  // namespace

Misfit misfit_of(const ParameterInfo& info, const Value& value, const std::vector<std::string>& places) {
  if (info.type == "number" || info.type == "integer") {
    if (!value.is_number() || (info.type == "integer" && !value.is_integer())) return Misfit::type;
    return in_range(info, value) ? Misfit::none : Misfit::range;
  }
  if (info.type == "text" || info.type == "place") {
    if (!value.is_text()) return Misfit::type;
    if (!info.one_of.empty() && !contains(info.one_of, value.text())) return Misfit::word;
    return info.type == "place" && !contains(places, value.text()) ? Misfit::place : Misfit::none;
  }
  if (info.type == "bool") return value.is_bool() ? Misfit::none : Misfit::type;
  return info.type == "numbers" ? of_numbers(info, value) : Misfit::none;
}

std::string misfit_text(Misfit misfit, const ParameterInfo& info, const Value& value, const std::string& robot) {
  switch (misfit) {
    case Misfit::none:
      return {};
    case Misfit::type:
      return "is " + in_words(value) + ", not " + type_text(info.type);
    case Misfit::range:
      return outside_text(info, outside(info, value));
    case Misfit::count:
      return "has " + std::to_string(value.list().size()) + " numbers, not " + std::to_string(info.count);
    case Misfit::place:
      return in_quotes(value.text()) + " is no place that " + in_quotes(robot) + " knows";
    case Misfit::word:
      return in_quotes(value.text()) + " is none of its words";
  }
  return {};
}

std::string misfit_cure(Misfit misfit, const ParameterInfo& info, const Value& value,
                        const std::vector<std::string>& places) {
  const std::vector<std::string> choices = choices_of(info, places);
  if (misfit == Misfit::place && info.one_of.empty())
    return did_you_mean(value.text(), choices, "add it to places.json of its node, or use one of");
  if (misfit == Misfit::place) {
    // One of the skill's own words: no slip, but known nowhere.
    return R"(add it to "places" of the robot's description (its own term), or to places.json if coordinates are sent)" +
           (choices.empty() ? "" : "; or use one of: " + join(choices));
  }
  if (misfit == Misfit::word) return did_you_mean(value.text(), choices.empty() ? info.one_of : choices, "use one of");
  return "use " + wanted_text(info);
}

std::vector<std::string> choices_of(const ParameterInfo& info, const std::vector<std::string>& places) {
  if (info.type != "place") return info.one_of;
  if (info.one_of.empty()) return places;
  std::vector<std::string> out;
  for (const std::string& one : info.one_of) {
    if (contains(places, one)) out.push_back(one);
  }
  return out;
}

std::string wanted_text(const ParameterInfo& info) {
  std::string out = "\"" + info.name + "\": ";
  if (info.type == "numbers") {
    out += "a list of " + (info.count == 0 ? "" : std::to_string(info.count) + " ") + "numbers" + range_text(info);
  } else if (info.type == "bool") {
    out += "true or false";
  } else if (info.type == "place") {
    out += "the name of a place, in quotes";
  } else if (info.type == "integer") {
    out += "a whole number" + range_text(info);
  } else {
    out += "a " + info.type + range_text(info);
  }
  return info.unit.empty() ? out : out + " in " + info.unit;
}

}  // namespace trb
