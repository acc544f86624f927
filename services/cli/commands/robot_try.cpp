// robot try: a person goes with a new robot through what it must do.
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <utility>

#include "common/fleet/did_you_mean.hpp"
#include "common/operator/try_robot.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"
#include "services/cli/io/questions.hpp"

namespace trb::cli {
namespace {

using Words = std::vector<std::string>;

Words list_of(const std::string& text) {
  Words out;
  std::istringstream words(text);
  for (std::string word; std::getline(words, word, ',');) out.push_back(word);
  return out;
}

/// SKILL.PARAMETER=VALUE with semicolons between them, for a place or a list has commas.
Result<std::map<std::string, std::string>> settings_of(const Arguments& arguments) {
  std::map<std::string, std::string> out;
  std::istringstream words(arguments.get("--set"));
  for (std::string word; std::getline(words, word, ';');) {
    const auto equals = word.find('=');
    if (equals == std::string::npos || word.find('.') >= equals) {
      return fail(Errc::bad_value, "--set: '" + word + "'", "write SKILL.PARAMETER=VALUE, with ';' between several");
    }
    out[word.substr(0, equals)] = word.substr(equals + 1);
  }
  return out;
}

/// Lines of the terminal, while the link to the node goes on.
class Terminal {
 public:
  explicit Terminal(Loop& loop) : loop_(loop) {}
  ~Terminal() { loop_.remove_fd(STDIN_FILENO); }
  Terminal(const Terminal&) = delete;
  Terminal& operator=(const Terminal&) = delete;

  void ask(const std::string& question, std::function<void(const std::string&)> then) {
    print_problem(question);
    then_ = std::move(then);
    loop_.add_fd(STDIN_FILENO, POLLIN, [this](short) { read(); });
  }

 private:
  void read() {
    char bytes[256];
    const ssize_t size = ::read(STDIN_FILENO, bytes, sizeof bytes);
    if (size > 0) line_.append(bytes, static_cast<std::size_t>(size));
    const auto end = line_.find('\n');
    if (end == std::string::npos && size > 0 && line_.size() < 4096) return;
    loop_.remove_fd(STDIN_FILENO);
    std::string line = line_.substr(0, end);
    line_.erase(0, end == std::string::npos ? line_.size() : end + 1);
    while (!line.empty() && (line.back() == ' ' || line.back() == '\r')) line.pop_back();
    std::exchange(then_, nullptr)(line);
  }

  Loop& loop_;
  std::string line_;
  std::function<void(const std::string&)> then_;
};

/// Who answers: the options, and at a terminal the person.
class Person {
 public:
  Person(const Arguments& arguments, std::map<std::string, std::string> settings, Loop& loop)
      : yes_(arguments.has("--yes")),
        asks_(can_ask() && !arguments.has("--json")),
        settings_(std::move(settings)),
        terminal_(loop) {}

  void may_try(const SkillInfo& skill, const std::function<void(bool)>& answer) {
    if (yes_) return answer(true);  // only skills that --skill names come here
    if (!asks_) return answer(false);
    terminal_.ask("try '" + skill.name + "' (" + skill.capability + ")? The robot may move: is its way free? y/N: ",
                  [answer](const std::string& line) { answer(line == "y" || line == "Y" || line == "yes"); });
  }

  void value_of(const SkillInfo& skill, const ParameterInfo& parameter, const Words& choices,
                const std::function<void(std::optional<std::string>)>& answer) {
    const auto set = settings_.find(skill.name + "." + parameter.name);
    if (set != settings_.end()) return answer(set->second);
    if (!asks_) return answer(std::nullopt);
    std::string known;
    for (const std::string& one : choices) known += (known.empty() ? ": " : ", ") + one;
    terminal_.ask("  " + parameter.name + " (" + parameter.type +
                      (parameter.unit.empty() ? "" : ", " + parameter.unit) + known + "): ",
                  [answer](const std::string& line) { answer(line.empty() ? std::nullopt : std::optional(line)); });
  }

 private:
  bool yes_;
  bool asks_;
  std::map<std::string, std::string> settings_;
  Terminal terminal_;
};

std::string_view word_of(op::TryState state) {
  if (state == op::TryState::unproved) return "not proved";
  return state == op::TryState::good ? "good" : state == op::TryState::failed ? "failed" : "not tried";
}

void print_step(const op::TryStep& step) {
  const Colour colour = step.state == op::TryState::good     ? Colour::good
                        : step.state == op::TryState::failed ? Colour::bad
                                                             : Colour::dim;
  std::string name = step.name;
  if (name.size() < 24) name.resize(24, ' ');
  print_line(name + " " + coloured(colour, std::string(word_of(step.state))) + "  " + step.text);
  if (!step.cure.empty()) print_line("                         put right: " + step.cure);
}

Value to_value(const op::TryStep& step) {
  return Value{Value::Object{{"step", Value{step.name}},
                             {"state", Value{std::string(word_of(step.state))}},
                             {"text", Value{step.text}},
                             {"cure", Value{step.cure}}}};
}

Status check_words(const Arguments& arguments) {
  if (!arguments.has("--yes") || !list_of(arguments.get("--skill")).empty()) return Done{};
  return fail(Errc::missing, "--yes: to which skills?",
              "name those that may move the robot now: --yes --skill NAME[,NAME]");
}

int run_try(const Arguments& arguments) {
  if (Status good = check_words(arguments); !good) return print_error(arguments, good.error());
  auto settings = settings_of(arguments);
  if (!settings) return print_error(arguments, settings.error());
  const auto connects = arguments.number("--timeout", 10);
  if (!connects) return print_error(arguments, connects.error());
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  op::TryWish wish;
  wish.skills = list_of(arguments.get("--skill"));
  wish.parameters = names_in(*settings);
  wish.must = arguments.has("--yes");
  Person person(arguments, std::move(*settings), probe->bus().loop());
  wish.robot = arguments.words[0];
  wish.connects = seconds(*connects);
  wish.person.may_try = [&](const SkillInfo& skill, std::function<void(bool)> answer) {
    person.may_try(skill, answer);
  };
  wish.person.value_of = [&](const SkillInfo& skill, const ParameterInfo& parameter, const Words& choices,
                             std::function<void(std::optional<std::string>)> answer) {
    person.value_of(skill, parameter, choices, answer);
  };
  if (!arguments.has("--json")) wish.person.see = print_step;
  const auto steps = probe->wait<std::vector<op::TryStep>>(
      [&](op::Session& session, const auto& done) { op::try_robot(session, std::move(wish), done); });
  if (!steps) return print_error(arguments, steps.error());
  const bool failed = std::ranges::any_of(*steps, [](const auto& step) { return step.state == op::TryState::failed; });
  if (arguments.has("--json")) {
    Value::List rows;
    for (const op::TryStep& step : *steps) rows.push_back(to_value(step));
    print_json(Value{Value::Object{
        {"robot", Value{arguments.words[0]}}, {"good", Value{!failed}}, {"steps", Value{std::move(rows)}}}});
  } else if (!failed) {
    print_line(arguments.words[0] + ": does what was tried");
  }
  return failed ? kFailed : kGood;
}

}  // namespace

std::vector<Command> robot_try_commands() {
  return {{{"robot", "try"},
           {"robot try ROBOT",
            "Goes through what a new robot must do: connect, tell its state and position, each skill after a question, "
            "stop,\n"
            "release; and says what to put right in which file. No skill is tried that nobody has said yes to.",
            {"--node DIR|the node to try from (else TRB_NODE, else this folder)",
             "--skill NAME[,NAME]|only these skills", "--yes|to the skills that --skill names: their way is free",
             "--set SKILL.PARAMETER=VALUE|a skill's parameter; ';' between several",
             "--timeout S|how long it may take to connect (10)", "--json|for programs; asks nothing"},
            {"trb robot try arm1", "trb robot try rover --yes --skill go_to --set go_to.place=dock"},
            1,
            1},
           run_try}};
}

}  // namespace trb::cli
