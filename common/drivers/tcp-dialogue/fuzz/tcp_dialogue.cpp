// What a robot that is spoken to in text answers: whole and in pieces, and the driver behind, with commands, an end of
// its own and a stop under way; and any bytes as its notation.
#include "common/drivers/tcp-dialogue/reader.hpp"
#include "common/drivers/tcp-dialogue/syntax.hpp"
#include "tests/fuzz/adapter_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::adapter;

Settings settings() {
  Settings out = robot_settings("rover", Mode::direct, "tcp-dialogue", "mobile");
  out.commands.texts = {{"answer_end", {";"}}, {"begin", {"LOGIN"}},  {"good", {"OK*"}},
                        {"bad", {"ERR*"}},     {"ignore", {"NOTE*"}}, {"keep_alive", {"PING"}}};
  out.commands.numbers = {{"keep_alive_s", 0.3}};
  out.commands.commands = {{"go", "FOLD\nGO {data} -> THERE* else LOST*"}, {"stop", "HALT"}, {"release", ""}};
  out.commands.values = {{"position", "WHERE -> AT {0} {1}"}, {"state", "STATE -> {0} where IDLE=0"}};
  out.commands.requests = {{"position", "position"}, {"state", "state"}};
  return out;
}

/// Every write is one line, and there is one at a time; a connection that the driver ends is dialled again.
void look_at_robot(AdapterUnderTest& adapter) {
  const RobotOutbox robot = adapter.core.take_robot_output();
  for (const RobotWrite& write : robot.writes)
    require(write.bytes.find('\n') == write.bytes.size() - 1, "what is written is a line");
  require(robot.writes.size() <= 1, "one line at a time");
  if (robot.closes.empty()) return;
  adapter.core.on_channel_down(Channel::command, "closed", adapter.now, adapter.out);
  adapter.connect(Channel::command);
}

void converse(BytesView input) {
  AdapterUnderTest adapter(settings());
  adapter.connect(Channel::command);
  look_at_robot(adapter);
  adapter.hear(Channel::command, "OK;");
  look_at_robot(adapter);
  adapter.order({MessageType::command, "operator", "rover", 1, 0, 0, 5000, Opaque{"go", "1"}});
  for (int i = 0; !input.empty(); ++i) {
    const std::size_t size = std::min<std::size_t>(20, input.size());
    adapter.hear(Channel::command, input.substr(0, size));
    input.remove_prefix(size);
    look_at_robot(adapter);
    if (i == 3) adapter.order({MessageType::command, "operator", "rover", 2, 0, 0, 5000, Stop{}});
    adapter.pass(std::chrono::milliseconds(110));
    look_at_robot(adapter);
  }
  adapter.check_answered(1);
  adapter.pass({});
  require(adapter.core.next_deadline() > adapter.now.mono || !adapter.core.next_deadline(), "nothing stays due");
}

void check_reader(BytesView input, const char* end) {
  drivers::AnswerReader one(end);
  drivers::AnswerReader two(end);
  std::vector<std::string> pieces;
  bool good = true;
  for (std::size_t i = 0; i < input.size() && good; ++i) {
    auto some = two.add(input.substr(i, 1));
    good = some.ok();
    for (std::string& answer : good ? *some : std::vector<std::string>()) pieces.push_back(std::move(answer));
  }
  const auto whole = one.add(input);
  require(whole.ok() == good, "pieces are bounded as the whole");
  if (whole) require(*whole == pieces, "pieces read as the whole");
  for (const std::string& answer : pieces) require(answer.size() <= drivers::AnswerReader::kMost, "bounded");
}

void check_notation(const std::string& text) {
  const auto lines = drivers::read_dialogue_lines(text, "##");
  require(lines.ok() || !lines.error().hint.empty(), "a refused line has a cure");
  for (const auto& line : lines ? *lines : std::vector<drivers::DialogueLine>()) {
    const auto filled = drivers::fill_dialogue_line(line, R"(["a", 2])", "##");
    require(!filled || (*filled + "##").find("##") == filled->size(), "a line ends once");
  }
  const auto question = drivers::read_dialogue_question(text, "\n");
  require(question.ok() || !question.error().hint.empty(), "a refused value has a cure");
  const auto pattern = drivers::Pattern::read(text);
  if (pattern) static_cast<void>(pattern->take(text));
}

}  // namespace

std::vector<Bytes> seeds() {
  return {"OK;IDLE;OK;AT 1 2;OK going;THERE;", "OK;\r\nNOTE x;OK;LOST;",        "ERR 1;ERR 2;OK", "OK;OK;",
          "GO {0} -> THERE* else LOST*",       "WHERE -> AT {0} {1} where A=1", "0,{{0},{1}},*"};
}

void run(BytesView input) {
  for (const char* end : {"\n", ";", "\r\n"}) check_reader(input, end);
  check_notation(std::string(input));
  converse(input);
}

}  // namespace trb::fuzz
