#include "services/cli/commands/replay.hpp"

#include <algorithm>
#include <sstream>

#include "common/base/files.hpp"
#include "services/cli/commands/model_terms.hpp"
#include "services/cli/core/sequence_chart.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/simulator.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kMostBytes = 512U << 20U;  // a million messages have some 200 MB
constexpr std::size_t kMostValues = 1'000'000;   // of a job, as the simulator takes it

/// A file of trb simulate --protocol talkrobots --trace, up to an event.
struct KeptTrace {
  Value job;
  std::vector<Value> messages;
  bool is_whole = false;  ///< up to the event; if unknown, false
};

Error no_trace(const std::string& file, std::size_t line) {
  return fail(Errc::malformed, file + ": line " + std::to_string(line) + " is none of a trace",
              "make it anew: trb simulate --protocol talkrobots --trace FILE");
}

bool is_message(const Value& line) {
  const auto has = [&](const char* key, bool (Value::*is)() const) {
    const Value* found = line.find(key);
    return found != nullptr && (found->*is)();
  };
  const bool texts = std::ranges::all_of(std::vector<const char*>{"phase", "from", "to", "subtype", "digest"},
                                         [&](const char* key) { return has(key, &Value::is_text); });
  return texts && has("at_s", &Value::is_number) && has("event", &Value::is_integer);
}

/// The last line: {"complete", "messages"}.
bool is_end(const Value& line) {
  const Value *complete = line.find("complete"), *messages = line.find("messages");
  return complete != nullptr && complete->is_bool() && messages != nullptr && messages->is_integer();
}

/// `until` 0: all of it.
Result<KeptTrace> read_trace(const std::string& file, std::uint64_t until) {
  const auto text = read_file(file, kMostBytes);
  if (!text) return text.error();
  std::istringstream lines(*text);
  std::string line;
  std::getline(lines, line);
  const auto first = parse_json(line, {.bytes = kMostBytes, .values = kMostValues});
  if (!first || !first->is_object() || first->find("job") == nullptr) return no_trace(file, 1);
  KeptTrace out{*first->find("job"), {}, false};
  for (std::size_t number = 2; std::getline(lines, line); ++number) {
    auto message = parse_json(line);
    if (message && message->is_object() && is_end(*message)) {
      out.is_whole = message->find("complete")->boolean() &&
                     message->find("messages")->integer() == static_cast<std::int64_t>(out.messages.size());
      break;
    }
    if (!message || !message->is_object() || !is_message(*message)) return no_trace(file, number);
    if (until != 0 && static_cast<std::uint64_t>(message->find("event")->integer()) > until) {
      out.is_whole = true;
      break;
    }
    out.messages.push_back(std::move(*message));
  }
  return out;
}

/// Of the run, and between computers.
bool is_of_run(const Value& message) {
  const std::string& phase = message.find("phase")->text();
  const bool of_run = phase == "task" || phase == "forward" || phase == "sensor" || phase == "fail";
  return of_run && message.find("from")->text() != message.find("to")->text();
}

void print_chart(const std::vector<Value>& messages, bool all) {
  std::vector<ChartRow> rows;
  for (const Value& one : messages) {
    if (!all && !is_of_run(one)) continue;
    rows.push_back({one.find("at_s")->number(), static_cast<std::uint64_t>(one.find("event")->integer()),
                    one.find("from")->text(), one.find("to")->text(), one.find("subtype")->text()});
  }
  print(sequence_chart(rows, {"cloud"}));
  if (rows.size() == messages.size()) return;
  print_line("\n" + std::to_string(messages.size() - rows.size()) +
             " messages within computers and of upkeep are left out; --all prints them");
}

void print_trace_note(const KeptTrace& trace) {
  if (trace.is_whole) return;
  print_line(
      "The trace may be cut off: its last line, which says that it is complete, is missing or does not fit. "
      "Traces of versions before it have none");
}

/// What was sent up to the event is what the trace has of it. Errors: conflict.
Status check_same(const KeptTrace& trace, const Value& state) {
  const bool none = trace.messages.empty();
  const bool same = state.find("messages")->integer() == static_cast<std::int64_t>(trace.messages.size()) &&
                    (none || state.find("digest")->text() == trace.messages.back().find("digest")->text());
  if (same) return Done{};
  return fail(Errc::conflict, "the replay sends other messages than the trace has up to that event",
              trace.is_whole ? "make the trace anew with this version's trb-simulator"
                             : "it may be cut off before that event: make the trace anew");
}

void print_state(const Value& state, const Value& answer) {
  print_line("\nAt event " + std::to_string(state.find("event")->integer()) + ", " +
             shown_number(state.find("at_s")->number()) +
             " s: " + std::to_string(answer.find("world")->find("tasks_done")->integer()) + " tasks are done");
  std::vector<std::vector<std::string>> rows{{"NODE", "LINKS", "RUN", "RECORDS", "ROBOT"}};
  for (const Value& node : state.find("nodes")->list()) {
    const Value* robot = node.find("robot");
    const bool up = node.find("up")->boolean();
    const std::string& run = node.find("run")->text();
    rows.push_back({node.find("id")->text(), up ? std::to_string(node.find("links")->integer()) : "down",
                    run.empty() ? "-" : run, std::to_string(node.find("records")->integer()),
                    robot == nullptr ? "-" : robot->text()});
  }
  print(format_table(rows));
}

Result<Value> answer_at(const KeptTrace& trace, std::uint64_t event) {
  Value job = trace.job;
  std::get<Value::Object>(job.is).emplace_back("until_event", Value{static_cast<std::int64_t>(event)});
  auto answer = run_simulator(job);
  if (!answer) return answer;
  const Value* state = answer->find("state");
  if (state == nullptr) {
    return fail(Errc::bad_value, "--until: it is over before event " + std::to_string(event),
                "it has " + std::to_string(answer->find("world")->find("events")->integer()) + " events");
  }
  if (const Status same = check_same(trace, *state); !same) return same.error();
  return answer;
}

}  // namespace

int run_replay(const Arguments& arguments) {
  for (const auto& [option, value] : arguments.options) {
    if (option == "--replay" || option == "--until" || option == "--all" || option == "--json") continue;
    return print_error(arguments, fail(Errc::bad_value, option + ": the trace has its own job", "leave it out"));
  }
  OptionReader reader(arguments);
  std::uint64_t until = 0;
  reader.read("--until", until);
  if (!reader.status()) return print_error(arguments, reader.status().error());
  if (arguments.has("--until") && until == 0)
    return print_error(arguments, fail(Errc::bad_value, "--until: 0 is no event", "the first one has the number 1"));
  const auto trace = read_trace(arguments.get("--replay"), until);
  if (!trace) return print_error(arguments, trace.error());
  const bool json = arguments.has("--json");
  if (until == 0) {
    if (json) {
      print_json(Value{Value::Object{
          {"job", trace->job}, {"messages", Value{trace->messages}}, {"complete", Value{trace->is_whole}}}});
      return kGood;
    }
    print_chart(trace->messages, arguments.has("--all"));
    print_trace_note(*trace);
    return kGood;
  }
  const auto answer = answer_at(*trace, until);
  if (!answer) return print_error(arguments, answer.error());
  if (json) {
    print_json(*answer->find("state"));
    return kGood;
  }
  print_chart(trace->messages, arguments.has("--all"));
  print_trace_note(*trace);
  print_state(*answer->find("state"), *answer);
  return kGood;
}

}  // namespace trb::cli
