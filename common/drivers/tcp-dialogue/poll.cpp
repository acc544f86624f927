#include "common/drivers/tcp-dialogue/poll.hpp"

#include <algorithm>

namespace trb::drivers {
namespace {

constexpr std::size_t kMostTold = 160;  ///< bytes of a robot's answer in a text for a person

}  // namespace

Error dialogue_refusal(const std::string& what, const std::string& answer) {
  return fail(Errc::robot_error, what + " was answered with: " + cut_utf8(answer, kMostTold),
              R"(look at the robot; if it meant yes, correct "good" and "bad" in commands.json)");
}

DialoguePoll::DialoguePoll(const std::map<std::string, DialogueQuestion>& questions, Duration period)
    : period_(period) {
  for (const auto& [name, question] : questions) {
    auto at = std::ranges::find(groups_, question.line, &Group::line);
    if (at == groups_.end()) at = groups_.insert(groups_.end(), {question.line, {}});
    at->values.emplace(name, question);
  }
}

void DialoguePoll::restart(Now now) {
  drop_values();
  at_ = 0;
  due_ = now.mono;
}

std::optional<MonotonicTime> DialoguePoll::due() const {
  return groups_.empty() ? std::nullopt : std::optional(due_);
}

DialoguePoll::Changes DialoguePoll::on_answer(const std::string& answer, const DialogueManner& manner, Now now) {
  Changes changes;
  const Group& group = groups_[at_];
  for (const auto& [name, question] : group.values) {
    if (!manner.is_bad(answer)) {
      take(name, question, answer, now, changes);
      continue;
    }
    const Error why = dialogue_refusal(group.line, answer);
    lose(name, fail(why.code, name + ": " + why.what, why.hint), changes, why.what);
  }
  if (++at_ == groups_.size()) {
    at_ = 0;
    due_ = std::max(due_ + period_, now.mono);
  }
  return changes;
}

void DialoguePoll::take(const std::string& name, const DialogueQuestion& question, const std::string& answer, Now now,
                        Changes& changes) {
  const auto found = question.pattern.take(answer);
  if (!found) {
    return lose(name,
                fail(Errc::robot_error,
                     name + ": " + question.line + " was answered with: " + cut_utf8(answer, kMostTold) +
                         ", which is not like " + question.pattern.text(),
                     "correct values." + name + " in commands.json"),
                changes);
  }
  RobotValue value{{}, "", now.mono};
  Value::List all;
  for (const std::string_view text : *found) {
    const auto named = question.numbers.find(text);
    const bool is_named = named != question.numbers.end();
    all.push_back(is_named ? Value{std::string(text)} : value_of_text(text));
    if (is_named) value.numbers.push_back(named->second);
    if (all.back().is_number()) value.numbers.push_back(all.back().number());
  }
  // A text without a number would shift the numbers after it to another index.
  if (value.numbers.size() != all.size()) value.numbers.clear();
  value.json = dump_json(all.size() == 1 ? all.front() : Value{std::move(all)});
  keep(name, std::move(value), changes);
}

}  // namespace trb::drivers
