#include "common/drivers/tcp-dialogue/commands.hpp"

#include <algorithm>

namespace trb::drivers {
namespace {

bool one_matches(const std::vector<Pattern>& patterns, std::string_view text) {
  return std::ranges::any_of(patterns, [&](const Pattern& one) { return one.matches(text); });
}

/// One vendor's part of commands.json.
class Reader {
 public:
  Reader(const VendorCommands& vendor, const VendorFaults& faults) : vendor_(vendor), faults_(faults) {}

  DialogueCommands read() {
    ends();
    manner();
    for (const auto& [subtype, words] : vendor_.commands) command(subtype, words);
    out_.values = read_part("values", vendor_.values, faults_, [&](const std::string& words) {
      return read_dialogue_question(words, out_.manner.line_end);
    });
    return std::move(out_);
  }

 private:
  void ends() {
    DialogueManner& manner = out_.manner;
    if (const std::string* given = text("line_end")) end("line_end", *given, manner.line_end);
    manner.answer_end = manner.line_end;
    if (const std::string* given = text("answer_end")) end("answer_end", *given, manner.answer_end);
    if (!manner.answer_end.empty()) return;
    faults_.add("answer_end", "is empty: where an answer ends would not be known",
                "add \"answer_end\", for example \";\" or \"crlf\"");
    manner.answer_end.push_back('\n');
  }
  void end(const std::string& key, const std::string& given, std::string& into) const {
    auto read = read_text_end(given);
    if (!read) return faults_.add(key, read.error());
    into = std::move(*read);
  }

  void manner() {
    DialogueManner& manner = out_.manner;
    manner.greeting = number("greeting", 0) != 0;
    manner.poll_s = number("poll_s", manner.poll_s);
    manner.timeout_s = number("timeout_s", manner.timeout_s);
    for (const std::string& line : all("begin")) fixed("begin", line, manner.begin);
    manner.good = patterns("good", false);
    manner.bad = patterns("bad", true);
    manner.ignored = patterns("ignore", true);
    keep_alive();
  }
  void keep_alive() {
    const std::string* line = text("keep_alive");
    const double period = number("keep_alive_s", 0);
    if ((line != nullptr) != (period > 0)) {
      const bool no_line = line == nullptr;
      return faults_.add(
          no_line ? "keep_alive" : "keep_alive_s", "is missing: the other one of the two is there",
          no_line ? "add \"keep_alive\", a line that changes nothing" : "add \"keep_alive_s\", 0.05 to 60");
    }
    std::vector<std::string> read;
    if (line != nullptr) fixed("keep_alive", *line, read);
    if (!read.empty()) out_.manner.keep_alive = read.front();
    out_.manner.keep_alive_s = period;
  }

  void command(const std::string& subtype, const std::string& words) {
    const std::string key = "commands." + subtype;
    auto read = read_dialogue_lines(words, out_.manner.line_end);
    if (!read) return faults_.add(key, read.error());
    if (read->empty() && !words.empty()) faults_.add(key, "is blank", "write the robot's words, a line each");
    for (const DialogueLine& one : *read) {
      if (subtype != "stop" && subtype != "release") break;
      if (!one.words.fill("", json_literal).ok())
        faults_.add(key, "needs data, and a " + subtype + " has none", "write the words themselves");
      if (one.end) faults_.add(key, "ends at a later line, and a " + subtype + " at its answer", "remove ->");
    }
    out_.commands.emplace(subtype, std::move(*read));
  }

  [[nodiscard]] std::vector<Pattern> patterns(const std::string& key, bool needs_literal) const {
    std::vector<Pattern> out;
    for (const std::string& one : all(key)) {
      auto pattern = Pattern::read(one);
      if (!pattern) {
        faults_.add(key, pattern.error());
      } else if (pattern->holes() > 0 || (needs_literal && !pattern->has_literal())) {
        faults_.add(key, "'" + one + "' would fit anything, or takes a value",
                    "write the words of such a line, with * for the rest");
      } else {
        out.push_back(std::move(*pattern));
      }
    }
    return out;
  }
  void fixed(const std::string& key, const std::string& line, std::vector<std::string>& into) const {
    auto read = read_fixed_line(line, out_.manner.line_end);
    if (!read) return faults_.add(key, read.error());
    into.push_back(std::move(*read));
  }

  [[nodiscard]] std::vector<std::string> all(const std::string& key) const {
    const auto at = vendor_.texts.find(key);
    return at == vendor_.texts.end() ? std::vector<std::string>() : at->second;
  }
  [[nodiscard]] const std::string* text(const std::string& key) const {
    const auto at = vendor_.texts.find(key);
    return at == vendor_.texts.end() || at->second.empty() ? nullptr : &at->second.front();
  }
  [[nodiscard]] double number(const char* key, double preset) const {
    const auto at = vendor_.numbers.find(key);
    return at == vendor_.numbers.end() ? preset : at->second;
  }

  const VendorCommands& vendor_;
  const VendorFaults& faults_;
  DialogueCommands out_;
};

}  // namespace

bool DialogueManner::is_bad(std::string_view answer) const {
  return one_matches(bad, answer);
}

bool DialogueManner::is_good(std::string_view answer) const {
  return !is_bad(answer) && (good.empty() || one_matches(good, answer));
}

bool DialogueManner::ignores(std::string_view line) const {
  return one_matches(ignored, line);
}

DialogueCommands read_dialogue_commands(const VendorCommands& vendor, const Description&, const VendorFaults& faults) {
  return Reader(vendor, faults).read();
}

}  // namespace trb::drivers
