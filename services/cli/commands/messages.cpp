// send, request, tap, stop, release.
#include <map>

#include "common/base/ids.hpp"
#include "common/transport/loop.hpp"
#include "proto/phase.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/core/answers.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

Value text(const std::string& value) {
  return Value{value};
}

/// The body for a subtype given by a person: JSON for a typed one, the words as they are otherwise.
Result<Body> body_of(const std::string& subtype, const std::string& data) {
  if (!is_valid_word(subtype))
    return fail(Errc::bad_value, "SUBTYPE: '" + subtype + "' is no word", "letters, digits, '_' and '-'");
  if (data.size() > kMaxDataSize) return fail(Errc::too_large, "DATA: over 1 MiB", "send it in parts");
  if (!is_typed(subtype)) return Body{Opaque{subtype, data}};
  auto bytes = body_from_json(subtype, data.empty() ? "{}" : data);
  if (!bytes) {
    auto like = body_to_json(subtype, "\x90");  // an empty array: every field at its default
    return fail(bytes.error().code, "DATA of " + subtype + ": " + bytes.error().what,
                like ? "write it like " + *like : bytes.error().cure);
  }
  return decode_body(subtype, *bytes);
}

void print_answer(const Arguments& arguments, const Message& answer) {
  if (arguments.has("--json")) return print_line(message_to_json(answer));
  if (const auto ack = answer.subtype == Ack::kSubtype ? decode<Ack>(answer.data) : Result<Ack>(Error{})) {
    print_line(answer.source + ": " + ack->state + (ack->text.empty() ? "" : ": " + ack->text));
    return;
  }
  auto body = is_typed(answer.subtype) ? body_to_json(answer.subtype, answer.data) : Result<std::string>(answer.data);
  print_line(answer.source + ": " + answer.subtype + " " + (body ? *body : body.error().text()));
}

int ask_and_print(const Arguments& arguments, const std::string& target, MessageType type, const std::string& subtype,
                  const std::string& data) {
  auto body = body_of(subtype, data);
  if (!body) return print_error(arguments, body.error());
  const auto wait = arguments.number("--timeout", 5);
  if (!wait) return print_error(arguments, wait.error());
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto left = static_cast<std::uint32_t>(*wait * 1000);
  const std::uint16_t flags = arguments.has("--take") ? kFlagTakeControl : 0;
  const Send send{.type = type, .target = target, .flags = flags, .remaining_ms = left, .body = std::move(*body)};
  if (type != MessageType::information) {
    auto answer = probe->ask(send, seconds(*wait));
    if (!answer) return print_error(arguments, answer.error());
    print_answer(arguments, *answer);
    return kGood;
  }
  // Information has no answer; a Nack, if there is one, is quick.
  const auto id = probe->send(send);
  if (!id) return print_error(arguments, id.error());
  while (auto message = probe->receive(std::chrono::milliseconds(300))) {
    const auto nack = message->reply_to == *id && message->subtype == Nack::kSubtype ? decode<Nack>(message->data)
                                                                                     : Result<Nack>(Error{});
    if (nack) return print_error(arguments, nack_error(*nack));
  }
  if (!arguments.has("--json")) print_line(target + ": sent (information has no answer)");
  return kGood;
}

int run_send(const Arguments& arguments) {
  static const std::map<std::string, MessageType> kTypes = {
      {"command", MessageType::command}, {"request", MessageType::request}, {"information", MessageType::information}};
  const auto type = kTypes.find(arguments.words[1]);
  if (type == kTypes.end()) {
    return print_error(
        arguments, fail(Errc::bad_value, "TYPE: '" + arguments.words[1] + "'", "use command, request or information"));
  }
  const std::string data = arguments.words.size() > 3 ? arguments.words[3] : "";
  return ask_and_print(arguments, arguments.words[0], type->second, arguments.words[2], data);
}

int run_request(const Arguments& arguments) {
  const std::string data = arguments.words.size() > 2 ? arguments.words[2] : "";
  return ask_and_print(arguments, arguments.words[0], MessageType::request, arguments.words[1], data);
}

// ---- tap

std::string one_line(const HeaderView& header, char direction) {
  auto body =
      is_typed(header.subtype) ? body_to_json(header.subtype, header.data) : Result<std::string>(Bytes(header.data));
  std::string shown = body ? *body : body.error().text();
  if (!is_utf8(shown)) shown = std::to_string(header.data.size()) + " bytes";
  constexpr std::size_t kShown = 160;
  if (shown.size() > kShown) shown = shown.substr(0, kShown) + "...";
  return to_iso8601(read_clocks().utc).substr(11, 12) + " " + direction + " " + std::string(name_of(header.type)) +
         " " + std::string(header.subtype) + "  " + std::string(header.source) + " -> " + std::string(header.target) +
         "  " + std::to_string(header.data.size()) + " B  " + shown;
}

/// The message as JSON, and first which way it passed and when.
std::string json_line(const HeaderView& header, char direction) {
  return std::string("{\"direction\":\"") + direction + "\",\"time\":\"" + to_iso8601(read_clocks().utc) + "\"," +
         message_to_json(to_message(header)).substr(1);
}

bool wanted(const Arguments& arguments, const HeaderView& header) {
  if (arguments.has("--subtype")) return header.subtype == arguments.get("--subtype");
  return arguments.has("--all") || phase_of(header.subtype) != CostPhase::upkeep;
}

int run_tap(const Arguments& arguments) {
  const auto most = arguments.number("--count", 1e8);
  const auto wait = arguments.number("--timeout", 1e8);
  if (!most || !wait) return print_error(arguments, (most ? wait : most).error());
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  Context context;
  const auto address = tap_address();
  if (!address) return print_error(arguments, address.error());
  Socket tap = Socket::tap_client(context, address->endpoint, address->keys());
  const MonotonicTime end = read_clocks().mono + seconds(*wait);
  double shown = 0;
  while (shown < *most && read_clocks().mono < end) {
    zmq::pollitem_t item{tap.handle(), 0, ZMQ_POLLIN, 0};
    zmq::poll(&item, 1, std::chrono::milliseconds(200));
    Frame direction;
    Frame frame;
    while (shown < *most && tap.receive(direction) && direction.more() && tap.receive(frame)) {
      const auto header = decode_frame(view_of(frame));
      if (!header || direction.size() != 1 || !wanted(arguments, *header)) continue;
      const char way = view_of(direction)[0];
      print_line(arguments.has("--json") ? json_line(*header, way) : one_line(*header, way));
      ++shown;
    }
  }
  return shown >= *most || !arguments.has("--count") ? kGood : kFailed;
}

// ---- stop and release

struct StopReport {
  std::string robot;
  std::string state;  ///< "confirmed", "sent", "unreachable"
  std::string text;
};

Result<std::vector<std::string>> stop_targets(const Arguments& arguments, Probe& probe) {
  if (!arguments.has("--all")) return arguments.words;
  auto table = probe.ask_node<RouteTable>(RouteListRequest{});
  if (!table) return table.error();
  std::vector<std::string> out;
  for (const Route& route : table->routes) {
    if (route.role == Role::robot) out.push_back(route.id);
  }
  return out;
}

void take_answer(const Message& message, StopReport& report) {
  if (message.subtype == Ack::kSubtype) {
    report.state = "confirmed";
    return;
  }
  auto nack = decode<Nack>(message.data);
  if (!nack) return;
  const bool reached = nack->code == errc_name(Errc::timeout) || nack->code == errc_name(Errc::robot_offline);
  report.state = reached ? "sent" : "unreachable";
  report.text = nack->code + ": " + nack->what;
}

/// Sends to all first, then gathers: one robot that is silent must not delay another's stop.
std::vector<StopReport> order_all(Probe& probe, const std::vector<std::string>& targets, const Body& body,
                                  Duration wait) {
  std::map<std::uint64_t, std::size_t> asked;
  std::vector<StopReport> reports;
  for (const std::string& target : targets) {
    const auto id = probe.send(Send{.type = MessageType::command, .target = target, .body = body});
    const bool sent = id && *id != 0;
    const std::string why = id ? "the router takes no message" : id.error().text();
    reports.push_back({target, sent ? "sent" : "unreachable", sent ? "no answer in time" : why});
    if (sent) asked[*id] = reports.size() - 1;
  }
  const MonotonicTime end = read_clocks().mono + wait;
  while (!asked.empty() && read_clocks().mono < end) {
    auto message = probe.receive(end - read_clocks().mono);
    if (!message) break;
    const auto at = asked.find(message->reply_to);
    if (at == asked.end() || !answers(*message, at->first, reports[at->second].robot)) continue;
    reports[at->second].text.clear();
    take_answer(*message, reports[at->second]);
    asked.erase(at);
  }
  return reports;
}

int order(const Arguments& arguments, const Body& body, const std::string& done) {
  if (arguments.words.empty() == !arguments.has("--all")) {
    return print_error(arguments, fail(Errc::missing, "which robot?", "name robots, or give --all"));
  }
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  auto targets = stop_targets(arguments, *probe);
  if (!targets) return print_error(arguments, targets.error());
  const auto wait = arguments.number("--timeout", 3);
  if (!wait) return print_error(arguments, wait.error());
  const auto reports = order_all(*probe, *targets, body, seconds(*wait));
  std::vector<std::vector<std::string>> rows{{"ROBOT", done, "WHY"}};
  Value::List list;
  bool all = true;
  for (const StopReport& report : reports) {
    all = all && report.state == "confirmed";
    rows.push_back({report.robot, report.state, report.text});
    list.push_back(Value{
        Value::Object{{"robot", text(report.robot)}, {"state", text(report.state)}, {"text", text(report.text)}}});
  }
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{{"robots", Value{std::move(list)}}}});
  } else {
    print(format_table(rows));
  }
  return all ? kGood : kFailed;
}

int run_stop(const Arguments& arguments) {
  return order(arguments, Stop{arguments.get("--reason", "trb stop")}, "STOP");
}
int run_release(const Arguments& arguments) {
  return order(arguments, Release{arguments.get("--reason", "trb release")}, "RELEASE");
}

const std::string kNode = "--node DIR|the node to speak from (else TRB_NODE, else this folder)";
const std::string kJson = "--json|for programs";
const std::string kTimeout = "--timeout S|how long to wait for an answer (5)";

}  // namespace

std::vector<Command> message_commands() {
  return {
      {{"send"},
       {"send TARGET TYPE SUBTYPE [DATA]",
        "Sends one message and prints the answer. TYPE is command, request or information.\n"
        "A robot is commanded by one node at a time, until 10 s after its last command; another is refused\n"
        "(control_held, naming the holder) unless it takes control over by word.",
        {kNode, kTimeout, "--take|take the control lease over from whoever commands the robot", kJson},
        {"trb send ur3 command move '[0.5,-1.2,1.0,-1.4,-1.57,0]'", "trb send pioneer1 information greeting 'hello'",
         "trb send ur3 command move '[0,-1.57,0,-1.57,0,0]' --take"},
        3,
        4},
       run_send},
      {{"request"},
       {"request TARGET SUBTYPE [DATA]",
        "Asks a robot and prints what it answers.",
        {kNode, kTimeout, kJson},
        {"trb request ur3 position", "trb request pioneer1 battery --json"},
        2,
        3},
       run_request},
      {{"tap"},
       {"tap",
        "Shows the messages that pass a node's router: < in, > out, = within the node.",
        {kNode, kJson, "--subtype WORD|this subtype alone", "--all|also keep-alives, lists, proofs of delivery",
         "--count N|end after N messages", "--timeout S|end after S seconds"},
        {"trb tap --node nodes/ur3", "trb tap --subtype baton --json"},
        0,
        0},
       run_tap},
      {{"stop"},
       {"stop [ROBOT ...]",
        "Stops robots and fences them until `trb release`. A software stop is no safety function (ISO 13850).",
        {kNode, "--all|every robot of the fleet", "--reason TEXT|for the record",
         "--timeout S|how long to wait for confirmations (3)", kJson},
        {"trb stop --all", "trb stop ur3 --reason 'hand in the cell'"},
        0,
        1000},
       run_stop},
      {{"release"},
       {"release [ROBOT ...]",
        "Lifts the fence of robots that were stopped.",
        {kNode, "--all|every robot of the fleet", "--reason TEXT|for the record",
         "--timeout S|how long to wait for confirmations (3)", kJson},
        {"trb release --all", "trb release ur3"},
        0,
        1000},
       run_release},
  };
}

}  // namespace trb::cli
