#include "services/cli/io/print.hpp"

#include <unistd.h>

#include <cstdio>
#include <cstdlib>

namespace trb::cli {

void print(const std::string& text) {
  std::fwrite(text.data(), 1, text.size(), stdout);
  std::fflush(stdout);
}

void print_line(const std::string& text) {
  print(text + "\n");
}

void print_json(const Value& value) {
  print_line(dump_json(value));
}

int print_error(const Arguments& arguments, const Error& error) {
  if (arguments.has("--json")) {
    Value::Object inner{
        {"code", Value{std::string(errc_name(error.code))}}, {"what", Value{error.what}}, {"cure", Value{error.cure}}};
    print_json(Value{Value::Object{{"error", Value{std::move(inner)}}}});
  } else {
    const std::string cure = error.cure.empty() ? "" : "\n     " + error.cure;
    std::fprintf(stderr, "trb: %s: %s%s\n", std::string(errc_name(error.code)).c_str(), error.what.c_str(),
                 cure.c_str());
  }
  return kFailed;
}

Value faults_json(const ConfigFaults& faults) {
  Value::List list;
  for (const ConfigFault& fault : faults) {
    list.push_back(Value{Value::Object{{"file", Value{fault.file}},
                                       {"key", Value{fault.key}},
                                       {"what", Value{fault.what}},
                                       {"cure", Value{fault.cure}},
                                       {"may_wait", Value{fault.may_wait}}}});
  }
  return Value{Value::Object{{"faults", Value{std::move(list)}}}};
}

int print_faults(const Arguments& arguments, const ConfigFaults& faults) {
  if (arguments.has("--json")) {
    print_json(faults_json(faults));
  } else {
    std::fputs(to_text(faults).c_str(), stderr);
    std::fprintf(stderr, "trb: %zu fault%s, nothing was started\n", faults.size(), faults.size() == 1 ? "" : "s");
  }
  return kFailed;
}

std::string coloured(Colour colour, const std::string& text) {
  static const bool terminal = ::isatty(STDOUT_FILENO) == 1 && std::getenv("NO_COLOR") == nullptr;
  if (!terminal || colour == Colour::plain) return text;
  const char* code = colour == Colour::good ? "32" : colour == Colour::bad ? "31" : "2";
  return "\x1b[" + std::string(code) + "m" + text + "\x1b[0m";
}

}  // namespace trb::cli
