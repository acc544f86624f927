#include "services/cli/io/print.hpp"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "common/base/printable.hpp"

namespace trb::cli {

namespace {

constexpr std::string_view kEscape = "\x1b[";
constexpr std::string_view kReset = "\x1b[0m";

/// The length of a colour of ours that begins the text, or 0.
std::size_t colour_at(std::string_view text) {
  for (const std::string_view colour :
       {std::string_view("\x1b[32m"), std::string_view("\x1b[31m"), std::string_view("\x1b[2m"), kReset}) {
    if (text.substr(0, colour.size()) == colour) return colour.size();
  }
  return 0;
}

std::string lost;  ///< why not all was written

}  // namespace

void print(const std::string& text) {
  // What is printed is mostly the words of other nodes and robots: of escapes only colours pass.
  std::string out;
  for (std::string_view left = text; !left.empty();) {
    const std::size_t colour = colour_at(left);
    out += left.substr(0, colour);
    left.remove_prefix(colour);
    std::size_t end = left.find(kEscape, colour == 0 ? 1 : 0);
    if (end == std::string_view::npos) end = left.size();
    out += printable(left.substr(0, end));
    left.remove_prefix(end);
  }
  errno = 0;
  const bool written = std::fwrite(out.data(), 1, out.size(), stdout) == out.size() && std::fflush(stdout) == 0;
  if (!written && lost.empty()) lost = std::strerror(errno);  // NOLINT(concurrency-mt-unsafe): one thread
}

const std::string& lost_output() {
  return lost;
}

void forget_lost_output() {
  lost.clear();
}

void print_problem(const std::string& text) {
  const std::string out = printable(text);
  std::fwrite(out.data(), 1, out.size(), stderr);
}

void print_line(const std::string& text) {
  std::size_t own = 0;
  while (own < text.size() && text[own] == '\n') ++own;
  print(text.substr(0, own) + in_one_line(std::string_view(text).substr(own)) + "\n");
}

void print_json(const Value& value) {
  print(dump_json(value) + "\n");
}

int print_error(const Arguments& arguments, const Error& error) {
  if (arguments.has("--json")) {
    Value::Object inner{
        {"code", Value{std::string(errc_name(error.code))}}, {"what", Value{error.what}}, {"cure", Value{error.hint}}};
    print_json(Value{Value::Object{{"error", Value{std::move(inner)}}}});
  } else {
    const std::string hint = error.hint.empty() ? "" : "\n     " + in_one_line(error.hint);
    print_problem("trb: " + std::string(errc_name(error.code)) + ": " + in_one_line(error.what) + hint + "\n");
  }
  return kFailed;
}

Value fault_list(const ConfigFaults& faults) {
  Value::List list;
  for (const ConfigFault& fault : faults) {
    list.push_back(Value{Value::Object{{"file", Value{fault.file}},
                                       {"key", Value{fault.key}},
                                       {"what", Value{fault.what}},
                                       {"cure", Value{fault.hint}},
                                       {"may_wait", Value{fault.may_wait}}}});
  }
  return Value{std::move(list)};
}

Value faults_json(const ConfigFaults& faults) {
  return Value{Value::Object{{"faults", fault_list(faults)}}};
}

int print_faults(const Arguments& arguments, const ConfigFaults& faults, const std::string& therefore) {
  if (arguments.has("--json")) {
    print_json(faults_json(faults));
  } else {
    print_problem(to_text(faults));
    const std::string count = std::to_string(faults.size()) + (faults.size() == 1 ? " fault" : " faults");
    print_problem("trb: " + count + (therefore.empty() ? "" : ", " + therefore) + "\n");
  }
  return kFailed;
}

std::string coloured(Colour colour, const std::string& text) {
  static const bool terminal = ::isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;
  if (!terminal || colour == Colour::plain) return text;
  const char* code = colour == Colour::good ? "32" : colour == Colour::bad ? "31" : "2";
  return std::string(kEscape) + code + "m" + text + std::string(kReset);
}

}  // namespace trb::cli
