#include "common/drivers/http-json/poll.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/number_text.hpp"
#include "common/config/robot_auth.hpp"
#include "common/drivers/http-json/session.hpp"

namespace trb::drivers {
namespace {

/// A text is a number where "number" stands behind its pointer; finite, and whole texts only.
std::optional<double> number_in(const Value& value) {
  if (value.is_number()) return value.number();
  const auto number = value.is_text() ? parse_number<double>(value.text()) : std::nullopt;
  return number && std::isfinite(*number) ? number : std::nullopt;
}

/// "-2" is told as a whole number.
Value value_of(double number) {
  constexpr double kExact = 1e15;
  const bool whole = std::abs(number) < kExact && std::trunc(number) == number;
  return whole ? Value{static_cast<std::int64_t>(number)} : Value{number};
}

/// A number, true and false as 1 and 0, or a text that has a number.
std::optional<double> number_of(const Value& value, const HttpQuestion::Part& part) {
  if (value.is_number()) return value.number();
  if (value.is_bool()) return value.boolean() ? 1 : 0;
  if (!value.is_text()) return std::nullopt;
  const auto at = part.numbers.find(value.text());
  return at == part.numbers.end() ? std::nullopt : std::optional(at->second);
}

/// Adds what stands at the pointer. Errors: robot_error.
Status add_part(const Value& json, const HttpQuestion::Part& part, RobotValue& value, Value::List& all) {
  const Value* at = find_by_pointer(json, part.pointer);
  if (at == nullptr)
    return fail(Errc::robot_error, "the answer has no " + part.pointer, "correct the pointer in commands.json");
  const auto number = part.is_number ? number_in(*at) : number_of(*at, part);
  if (part.is_number && !number) {
    return fail(Errc::robot_error, "what stands at " + part.pointer + " is no number",
                "correct the pointer in commands.json, or remove \"number\"");
  }
  if (number) value.numbers.push_back(*number);
  all.push_back(part.is_number ? value_of(*number) : *at);
  return Done{};
}

}  // namespace

Error http_refusal(const std::string& what, const HttpAnswer& answer) {
  constexpr std::size_t kMost = 160;
  const bool refuses_sign_in = answer.status == 401;
  const bool forbids = answer.status == 403;
  std::string text = what + " was answered with " + std::to_string(answer.status);
  const std::string asked = refuses_sign_in ? asked_schemes(answer) : "";
  if (refuses_sign_in) text += std::string(", the robot ") + kSignInRefused;
  if (forbids) text += std::string(", the robot ") + kNotAllowed;
  if (!asked.empty()) text += " and asks for " + asked;
  if (!answer.body.empty()) text += ": " + cut_utf8(answer.body, kMost);
  if (refuses_sign_in) return fail(Errc::robot_error, text, kSignInCure);
  if (forbids) return fail(Errc::robot_error, text, kNotAllowedCure);
  return fail(Errc::robot_error, text, "compare commands.json with the maker's description of the interface");
}

HttpPoll::HttpPoll(const std::map<std::string, HttpQuestion>& questions, HttpPath probe, Duration period)
    : period_(period) {
  for (const auto& [name, question] : questions) {
    const auto same = [&path = question.path](const Group& group) { return group.path.text() == path.text(); };
    auto at = std::ranges::find_if(groups_, same);
    if (at == groups_.end()) at = groups_.insert(groups_.end(), {question.path, {}});
    at->values[name] = question.parts;
  }
  if (groups_.empty()) groups_.push_back({std::move(probe), {}});
}

std::optional<std::string> HttpPoll::next(const Remembered& remembered, Now now) {
  for (std::size_t i = at_; i < groups_.size(); ++i) {
    at_ = i;
    if (auto target = groups_[i].path.fill(remembered)) return std::move(*target);
  }
  at_ = groups_.size() - 1;
  advance(now);
  return std::nullopt;
}

HttpPoll::Changes HttpPoll::on_answer(const HttpAnswer& answer, Now now) {
  Changes changes;
  const Group& group = groups_[at_];
  const std::string what = "GET " + group.path.text();
  const auto json = answer.good() ? parse_json(answer.body) : Result<Value>(http_refusal(what, answer));
  for (const auto& [name, parts] : group.values) take(name, parts, json, now, changes);
  advance(now);
  return changes;
}

void HttpPoll::take(const std::string& name, const std::vector<HttpQuestion::Part>& parts, const Result<Value>& json,
                    Now now, Changes& changes) {
  if (!json) {
    const Error& why = json.error();
    return lose(name, fail(Errc::robot_error, name + ": " + why.what, why.hint), changes, why.what);
  }
  RobotValue value{{}, "", now.mono};
  Value::List all;
  for (const HttpQuestion::Part& part : parts) {
    if (const Status added = add_part(*json, part, value, all); !added) {
      const Error& why = added.error();
      return lose(name, fail(why.code, name + ": " + why.what, why.hint), changes);
    }
  }
  // A text without a number would shift the numbers after it to another index.
  if (value.numbers.size() != parts.size()) value.numbers.clear();
  value.json = dump_json(parts.size() == 1 ? all.front() : Value{std::move(all)});
  keep(name, std::move(value), changes);
}

void HttpPoll::forget(std::string_view name) {
  for (const Group& group : groups_) {
    const std::vector<std::string> names = group.path.names();
    if (std::ranges::find(names, name) == names.end()) continue;
    for (const auto& [value, parts] : group.values) erase(value);
  }
}

void HttpPoll::advance(Now now) {
  if (++at_ < groups_.size()) return;
  at_ = 0;
  due_ = std::max(due_ + period_, now.mono);
}

}  // namespace trb::drivers
