#include "services/cli/core/arguments.hpp"

#include <cstdint>

#include "common/base/number_text.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::cli {
namespace {

std::string option_name(const std::string& spec) {
  return spec.substr(0, spec.find_first_of(" |"));
}

bool takes_value(const std::string& spec) {
  const auto space = spec.find(' ');
  return space != std::string::npos && space < spec.find('|');
}

const std::string* find_option(const Usage& usage, const std::string& name) {
  for (const std::string& spec : usage.options) {
    if (option_name(spec) == name) return &spec;
  }
  return nullptr;
}

Error unknown_option(const Usage& usage, const std::string& word) {
  std::vector<std::string> names;
  std::string known;
  for (const std::string& spec : usage.options) {
    names.push_back(option_name(spec));
    known += " " + names.back();
  }
  const std::string near = nearest(word, names);
  if (!near.empty()) return fail(Errc::bad_value, "unknown option '" + word + "'", "did you mean " + near + "?");
  return fail(Errc::bad_value, "unknown option '" + word + "'",
              known.empty() ? "this command has no options" : "use one of" + known);
}

}  // namespace

std::string Arguments::get(const std::string& option, const std::string& otherwise) const {
  const auto at = options.find(option);
  return at == options.end() ? otherwise : at->second;
}

Result<double> Arguments::number(const std::string& option, double otherwise, double most) const {
  if (!has(option)) return otherwise;
  const std::string text = get(option);
  const auto value = parse_number<double>(text);
  if (!value || !(*value > 0))
    return fail(Errc::bad_value, option + ": '" + text + "' is no positive number",
                "write, for example, " + option + " 5");
  if (*value > most) {
    const std::string bound = std::to_string(static_cast<std::int64_t>(most));
    return fail(Errc::bad_value, option + ": '" + text + "' is over " + bound, "use at most " + bound);
  }
  return *value;
}

namespace {

/// The option at given[i]; moves i on to its value, if that is a word of its own.
Status take_option(const Usage& usage, const std::vector<std::string>& given, std::size_t& i, Arguments& out) {
  const std::string& word = given[i];
  const auto equals = word.find('=');
  const std::string name = word.substr(0, equals);
  const std::string* spec = find_option(usage, name);
  if (spec == nullptr) return unknown_option(usage, name);
  if (!takes_value(*spec) && equals != std::string::npos) {
    return fail(Errc::bad_value, word + ": " + name + " takes no value", "write " + name + ", or leave it out");
  }
  std::string& value = out.options[name];
  if (!takes_value(*spec)) {
    value.clear();
  } else if (equals != std::string::npos) {
    value = word.substr(equals + 1);
  } else if (i + 1 < given.size()) {
    value = given[++i];
  } else {
    return fail(Errc::missing, name + ": needs a value", "write " + spec->substr(0, spec->find('|')));
  }
  out.every[name].push_back(value);
  return Done{};
}

}  // namespace

Result<Arguments> parse_arguments(const Usage& usage, const std::vector<std::string>& given) {
  Arguments out;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string& word = given[i];
    if (word.rfind("--", 0) != 0) {
      out.words.push_back(word);
      continue;
    }
    if (Status taken = take_option(usage, given, i, out); !taken) return taken.error();
  }
  if (out.words.size() < usage.least) return fail(Errc::missing, "too few words", "trb " + usage.words);
  const bool is_name = !out.words.empty() && out.words.front().empty();
  if (is_name) {
    return fail(Errc::bad_value, "the first word is empty", "is a variable of a script not set? trb " + usage.words);
  }
  if (out.words.size() > usage.most) {
    return fail(Errc::bad_value, "'" + out.words[usage.most] + "' is one word too many", "trb " + usage.words);
  }
  return out;
}

std::string help_text(const Usage& usage) {
  std::string out = "trb " + usage.words + "\n\n" + usage.summary + "\n";
  if (!usage.options.empty()) out += "\nOptions:\n";
  for (const std::string& spec : usage.options) {
    const auto bar = spec.find('|');
    std::string left = "  " + spec.substr(0, bar);
    left.resize(std::max<std::size_t>(left.size() + 1, 22), ' ');
    out += left + (bar == std::string::npos ? "" : spec.substr(bar + 1)) + "\n";
  }
  if (!usage.examples.empty()) out += "\nExamples:\n";
  for (const std::string& example : usage.examples) out += "  " + example + "\n";
  return out;
}

}  // namespace trb::cli
