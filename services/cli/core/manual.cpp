#include "services/cli/core/manual.hpp"

#include <algorithm>
#include <cctype>

namespace trb::cli {
namespace {

/// A backslash, a hyphen that is typed, a full stop or an apostrophe at a line's beginning mean something to troff.
std::string escaped(const std::string& text) {
  std::string out;
  bool begins = true;
  for (const char c : text) {
    if (begins && (c == '.' || c == '\'')) out += "\\&";
    if (c == '\\') {
      out += "\\e";
    } else if (c == '-') {
      out += "\\-";
    } else {
      out += c;
    }
    begins = c == '\n';
  }
  return out;
}

std::string upper(std::string text) {
  std::ranges::transform(text, text.begin(), [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

/// As it is written, line by line.
std::string example(const std::string& text) {
  return ".EX\n" + escaped(text) + (text.ends_with('\n') ? "" : "\n") + ".EE\n";
}

std::string command_section(const CommandText& command) {
  std::string out = ".SS trb " + escaped(command.usage.words) + "\n" + escaped(command.usage.summary) + "\n";
  for (const std::string& spec : command.usage.options) {
    const OptionText option = option_text(spec);
    out += ".TP\n\\fB" + escaped(option.name) + "\\fR" +
           (option.value.empty() ? "" : " \\fI" + escaped(option.value) + "\\fR") + "\n" + escaped(option.what) + "\n";
  }
  if (command.usage.examples.empty()) return out;
  std::string examples;
  for (const std::string& one : command.usage.examples) examples += one + "\n";
  return out + ".PP\nExamples:\n.PP\n.RS 4\n" + example(examples) + ".RE\n";
}

}  // namespace

std::string manual_page(const std::vector<CommandText>& commands,
                        const std::vector<std::pair<std::string, std::string>>& topics, const std::string& version) {
  std::string out =
      ".TH TRB 1 \"\" \"TalkRoBots " + escaped(version) +
      "\" \"TalkRoBots\"\n"
      ".SH NAME\ntrb \\- probes and controls for a TalkRoBots fleet\n"
      ".SH SYNOPSIS\n\\fBtrb\\fR \\fICOMMAND\\fR [\\fIWORD\\fR ...] [\\fIOPTION\\fR ...]\n.br\n"
      "\\fBtrb\\fR \\fICOMMAND\\fR \\fB\\-\\-help\\fR\n.br\n"
      "\\fBtrb help\\fR [\\fICOMMAND\\fR|\\fITOPIC\\fR]\n"
      ".SH DESCRIPTION\nRobots of different makers send each other messages by TalkRoBots. \\fBtrb\\fR starts a "
      "node's services, asks them, commands robots, and makes and keeps a fleet.\n"
      ".SH COMMANDS\n";
  for (const CommandText& command : commands) out += command_section(command);
  out +=
      ".SH ENVIRONMENT\n.TP\n\\fBTRB_NODE\\fR\nThe node's folder, where \\fB\\-\\-node\\fR is not given.\n"
      ".SH EXIT STATUS\n.TP\n0\nIt is done.\n.TP\n1\nIt failed; the error tells why, and what to do.\n"
      ".TP\n2\nThe command line is wrong.\n";
  for (const auto& [name, text] : topics) out += ".SH \"TOPIC " + upper(name) + "\"\n" + example(text);
  return out;
}

}  // namespace trb::cli
