#include "services/virtual-robots/lines/virtual_lines.hpp"
#include "services/virtual-robots/support/control.hpp"
#include "services/virtual-robots/support/robot_main.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace {

using namespace trb::virtual_robots;

void require(bool condition, std::string_view text) {
  if (!condition) throw OptionError("not understood: " + std::string(text));
}

template <typename Value>
Value required(std::optional<Value> value, std::string_view text) {
  require(value.has_value(), text);
  return *value;
}

void add_skill(lines::BodySettings& body, std::string_view text) {
  const std::size_t equals = text.find('=');
  require(equals != std::string_view::npos && equals > 0, text);
  body.skills[std::string(text.substr(0, equals))] = number_option(text.substr(equals + 1), 0, 1e6);
}

void add_failure(lines::BodySettings& body, std::string_view text) {
  const std::size_t colon = text.rfind(':');
  std::set<int>& calls = body.failures[std::string(text.substr(0, colon))];
  if (colon != std::string_view::npos) calls.insert(static_cast<int>(number_option(text.substr(colon + 1), 1, 1e6)));
}

std::vector<Option> channel_options(lines::Settings& settings) {
  lines::SessionSettings& session = settings.session;
  return {
      {"--framing", "newline|length|delay", "how fields are told apart (newline)",
       [&](auto text) { session.frame.framing = required(lines::parse_framing(text), text); }},
      {"--delay-s", "S", "the pause of the delay framing (0.01)",
       [&](auto text) { session.frame.delay_s = number_option(text, 0.0001, 60); }},
      {"--encoding", "text|numeric", "words or numbers (text)",
       [&](auto text) {
         require(text == "text" || text == "numeric", text);
         session.vocabulary.numeric = text == "numeric";
       }},
      {"--code", "KIND:WORD=N", "a number of the numeric encoding; KIND is subtype or id; repeated",
       [&](auto text) { require(session.vocabulary.codes.add(text), text); }},
      {"--no-ack", "", "acknowledge no field", [&](auto) { session.acknowledge = false; }},
      {"--chunk-bytes", "N", "longest chunk sent and longest line accepted; 0: no limit (0)",
       [&](auto text) { session.frame.chunk_bytes = static_cast<std::size_t>(number_option(text, 0, 1e6)); }},
      {"--slow-read-ms", "N", "wait between two reads",
       [&](auto text) { settings.slow_read_s = number_option(text, 0, 60000) / 1000; }},
      {"--hang-after", "N", "read nothing any more after N messages",
       [&](auto text) { session.hang_after = static_cast<std::size_t>(number_option(text, 0, 1e9)); }},
  };
}

std::vector<Option> options_of(lines::Settings& settings) {
  lines::BodySettings& body = settings.body;
  std::vector<Option> options = {
      {"--node", "ADDRESS:PORT", "the node to dial (needed)",
       [&](auto text) { settings.node = required(parse_endpoint(text), text); }},
      {"--from", "ADDRESS", "the address to dial from", [&](auto text) { settings.source = text; }},
      {"--name", "NAME", "the robot's name (robot)", [&](auto text) { settings.session.own_name = text; }},
      {"--skill", "NAME=SECONDS", "a skill and how long it takes; repeated", [&](auto text) { add_skill(body, text); }},
      {"--fail", "SKILL[:N]", "the Nth call of a skill fails; without N every call; repeated",
       [&](auto text) { add_failure(body, text); }},
      {"--pose", "X,Y,YAW", "where the robot stands (0,0,0)",
       [&](auto text) { body.start = required(lines::parse_pose(text, ','), text); }},
      {"--battery", "PERCENT", "charge at the start (100)",
       [&](auto text) { body.battery = number_option(text, 0, 100); }},
      {"--speed", "N", "skills run N times faster (1)",
       [&](auto text) { settings.speed = number_option(text, 0.001, 100000); }},
      control_option(settings.control),
  };
  for (Option& option : channel_options(settings)) options.push_back(std::move(option));
  return options;
}

}  // namespace

int main(int argc, char** argv) {
  lines::Settings settings;
  settings.session.own_name = "robot";
  return robot_main(
      argc, argv, {"trb-virtual-lines-robot", "a robot on the field channel", options_of(settings), [&](const Fd& end) {
                     if (settings.node.port == 0) throw OptionError("--node ADDRESS:PORT is needed");
                     lines::VirtualLines(settings).run(end);
                   }});
}
