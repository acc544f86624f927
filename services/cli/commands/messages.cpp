// send, request, tap, drive, stop, release.
#include <map>
#include <memory>

#include "common/operator/io/tap.hpp"
#include "common/operator/order_robots.hpp"
#include "common/operator/user_message.hpp"
#include "services/cli/commands/command.hpp"
#include "services/cli/commands/drive.hpp"
#include "services/cli/core/table.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

void print_answer(const Arguments& arguments, const Message& answer) {
  if (arguments.has("--json")) return print_line(message_to_json(answer));
  if (const auto ack = answer.subtype == Ack::kSubtype ? decode<Ack>(answer.data) : Result<Ack>(Error{})) {
    print_line(answer.source + ": " + ack->state + (ack->text.empty() ? "" : ": " + ack->text));
    return;
  }
  auto body = is_typed(answer.subtype) ? body_to_json(answer.subtype, answer.data) : Result<std::string>(answer.data);
  print_line(answer.source + ": " + answer.subtype + " " + (body ? *body : body.error().text()));
}

int request_and_print(const Arguments& arguments, const std::string& target, MessageType type,
                      const std::string& subtype, const std::string& data) {
  auto body = op::user_body(subtype, data);
  if (!body) return print_error(arguments, body.error());
  const auto wait = arguments.number("--timeout", 5);
  if (!wait) return print_error(arguments, wait.error());
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto left = static_cast<std::uint32_t>(*wait * 1000);
  const std::uint16_t flags = arguments.has("--take") ? kFlagTakeControl : 0;
  const Send send{.type = type, .target = target, .flags = flags, .remaining_ms = left, .body = std::move(*body)};
  if (type != MessageType::information) {
    const auto answer = probe->wait<Message>(
        [&](op::Session& session, const auto& done) { session.request(send, done, seconds(*wait)); });
    if (!answer) return print_error(arguments, probe->with_nearest(answer.error(), target, true));
    print_answer(arguments, *answer);
    return kGood;
  }
  const auto sent =
      probe->wait<Done>([&](op::Session& session, const auto& done) { op::send_information(session, send, done); });
  if (!sent) return print_error(arguments, probe->with_nearest(sent.error(), target, true));
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
  return request_and_print(arguments, arguments.words[0], type->second, arguments.words[2], data);
}

int run_request(const Arguments& arguments) {
  const std::string data = arguments.words.size() > 2 ? arguments.words[2] : "";
  return request_and_print(arguments, arguments.words[0], MessageType::request, arguments.words[1], data);
}

// ---- tap

std::string one_line(const op::TapRecord& record) {
  const HeaderView& header = record.header;
  auto body =
      is_typed(header.subtype) ? body_to_json(header.subtype, header.data) : Result<std::string>(Bytes(header.data));
  std::string shown = body ? *body : body.error().text();
  if (!is_utf8(shown)) shown = std::to_string(header.data.size()) + " bytes";
  constexpr std::size_t kShown = 160;
  if (shown.size() > kShown) shown = shown.substr(0, kShown) + "...";
  return to_iso8601(record.time).substr(11, 12) + " " + record.direction + " " + std::string(name_of(header.type)) +
         " " + std::string(header.subtype) + "  " + std::string(header.source) + " -> " + std::string(header.target) +
         "  " + std::to_string(header.data.size()) + " B  " + shown;
}

op::TapFilter filter_of(const Arguments& arguments) {
  op::TapFilter out;
  if (arguments.has("--subtype")) out.subtype = arguments.get("--subtype");
  out.all = arguments.has("--all");
  return out;
}

int run_tap(const Arguments& arguments) {
  const auto most = arguments.number("--count", 1e8);
  const auto wait = arguments.number("--timeout", 1e8);
  if (!most || !wait) return print_error(arguments, (most ? wait : most).error());
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto address = tap_address();
  if (!address) return print_error(arguments, address.error());
  double shown = 0;
  const auto show = [&](const op::TapRecord& record) {
    print_line(arguments.has("--json") ? op::to_json(record) : one_line(record));
    return ++shown < *most;
  };
  Context context;
  const op::Tap tap(context, probe->bus().loop(), *address, filter_of(arguments), show);
  bool over = false;
  probe->session().after(seconds(*wait), [&over] { over = true; });
  probe->wait_until([&] { return over || shown >= *most; });
  return shown >= *most || !arguments.has("--count") ? kGood : kFailed;
}

// ---- stop and release

Result<std::vector<std::string>> robots_to_order(const Arguments& arguments, Probe& probe) {
  if (!arguments.has("--all")) return arguments.words;
  const auto table = probe.routes();
  return table ? Result<std::vector<std::string>>(op::robots_of(*table)) : table.error();
}

int print_orders(const Arguments& arguments, const std::vector<op::RobotOrder>& orders, const std::string& done) {
  std::vector<std::vector<std::string>> rows{{"ROBOT", done, "WHY"}};
  Value::List list;
  bool all = true;
  for (const op::RobotOrder& one : orders) {
    all = all && one.state == "confirmed";
    rows.push_back({one.robot, one.state, one.text});
    list.push_back(
        Value{Value::Object{{"robot", Value{one.robot}}, {"state", Value{one.state}}, {"text", Value{one.text}}}});
  }
  if (arguments.has("--json")) {
    print_json(Value{Value::Object{{"robots", Value{std::move(list)}}}});
  } else {
    print(format_table(rows));
  }
  return all ? kGood : kFailed;
}

/// A misspelt robot is told with the one that was probably meant.
void add_nearest(Probe& probe, std::vector<op::RobotOrder>& orders) {
  const std::string code(errc_name(Errc::unknown_target));
  for (op::RobotOrder& one : orders) {
    if (!one.text.starts_with(code + ":")) continue;
    const Error error = probe.with_nearest(fail(Errc::unknown_target, one.text), one.robot);
    if (!error.hint.empty()) one.text += "; " + error.hint;
  }
}

int order(const Arguments& arguments, const Body& body, const std::string& done) {
  if (arguments.words.empty() && !arguments.has("--all")) {
    return print_error(arguments, fail(Errc::missing, "which robot?", "name robots, or give --all"));
  }
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  const auto robots = robots_to_order(arguments, *probe);
  if (!robots) return print_error(arguments, robots.error());
  // An empty table would look as if all were done.
  if (robots->empty()) {
    return print_error(arguments, fail(Errc::missing, "nothing is ordered: " + probe->node() + " knows no robot",
                                       "see trb route list; name the robots, or send from another node: --node DIR"));
  }
  const auto wait = arguments.number("--timeout", 3);
  if (!wait) return print_error(arguments, wait.error());
  auto orders = probe->wait<std::vector<op::RobotOrder>>([&](op::Session& session, const auto& gathered) {
    op::order_robots(session, *robots, body, seconds(*wait), gathered);
  });
  add_nearest(*probe, *orders);
  return print_orders(arguments, *orders, done);
}

int run_stop(const Arguments& arguments) {
  return order(arguments, Stop{arguments.get("--reason", "trb stop")}, "STOP");
}
int run_release(const Arguments& arguments) {
  // A stop with both stops them all; what is let go must be meant.
  if (arguments.has("--all") && !arguments.words.empty()) {
    return print_error(arguments, fail(Errc::conflict, "--all: robots are named, too", "name robots, or give --all"));
  }
  return order(arguments, Release{arguments.get("--reason", "trb release")}, "RELEASE");
}

const std::string kTimeout = "--timeout S|how long to wait for an answer (5)";

const std::vector<Command> kMessageCommands = {
    {{"send"},
     {"send TARGET TYPE SUBTYPE [DATA]",
      "Sends one message and prints the answer. TYPE is command, request or information.\n"
      "A robot is commanded by one node at a time, until 10 s after its last command; another is refused\n"
      "(control_held, naming the holder) unless it takes control over by word.",
      {kSendingNode, kTimeout, "--take|take the control lease over from whoever commands the robot", kJson},
      {"trb send ur3 command move '[0.5,-1.2,1.0,-1.4,-1.57,0]'", "trb send pioneer1 information greeting 'hello'",
       "trb send ur3 command move '[0,-1.57,0,-1.57,0,0]' --take"},
      3,
      4},
     run_send},
    {{"request"},
     {"request TARGET SUBTYPE [DATA]",
      "Asks a robot and prints what it answers.",
      {kSendingNode, kTimeout, kJson},
      {"trb request ur3 position", "trb request pioneer1 battery --json"},
      2,
      3},
     run_request},
    {{"tap"},
     {"tap",
      "Shows the messages that pass a node's router: < in, > out, = within the node.",
      {kSendingNode, kJson, "--subtype WORD|this subtype alone", "--all|also keep-alives, lists, proofs of delivery",
       "--count N|end after N messages", "--timeout S|end after S seconds"},
      {"trb tap --node nodes/ur3", "trb tap --subtype baton --json"},
      0,
      0},
     run_tap},
    {{"drive"},
     {"drive ROBOT --speeds S,S...",
      "Drives a robot by hand: the same speeds for a while, then it stands. Prints how long messages took.\n"
      "If this program dies, the robot's own node lets it stand after 250 ms. trb stop ROBOT stops it at once.",
      {"--speeds S,S...|of the part's axes, in m/s and rad/s; those that are left out are 0",
       "--part P|base, joints, tool or belt (the first that the robot has)", "--for S|how long, in seconds (2)",
       "--take|takes control from who has it", "--person NAME|who drives ($USER)",
       "--node DIR|the node to send from: a cloud's, or the robot's own (else TRB_NODE, else this folder)", kJson},
      {"trb drive pioneer --speeds 0.2,0", "trb drive ur3 --part tool --speeds 0,0,0.05 --for 1",
       "trb drive conveyor --speeds=-0.1 --take"},
      1,
      1},
     run_drive},
    {{"stop"},
     {"stop [ROBOT ...]",
      "Stops robots and fences them until `trb release`. A software stop is no safety function (ISO 13850).",
      {kSendingNode, "--all|every robot of the fleet, whoever is named beside it", "--reason TEXT|for the record",
       "--timeout S|how long to wait for confirmations (3)", kJson},
      {"trb stop --all", "trb stop ur3 --reason 'hand in the cell'"},
      0,
      1000},
     run_stop},
    {{"release"},
     {"release [ROBOT ...]",
      "Lifts the fence of robots that were stopped.",
      {kSendingNode, "--all|every robot of the fleet", "--reason TEXT|for the record",
       "--timeout S|how long to wait for confirmations (3)", kJson},
      {"trb release --all", "trb release ur3"},
      0,
      1000},
     run_release},
};

}  // namespace

std::vector<Command> message_commands() {
  return kMessageCommands;
}

}  // namespace trb::cli
