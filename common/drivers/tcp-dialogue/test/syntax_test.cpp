// The notation of commands.json for a robot that answers in text, and the check of it.
#include "common/drivers/tcp-dialogue/syntax.hpp"

#include <doctest/doctest.h>

#include "common/drivers/tcp-dialogue/reader.hpp"
#include "tests/support/node_folder.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

/// "1.5|x": what the holes take; "-": it does not match.
std::string taken(const char* pattern, const std::string& line) {
  const auto read = Pattern::read(pattern);
  REQUIRE_MESSAGE(read.ok(), pattern);
  const auto parts = read->take(line);
  if (!parts) return "-";
  std::string out;
  for (const std::string_view part : *parts) out += (out.empty() ? "" : "|") + std::string(part);
  return out;
}

std::string faults_of(const NodeFolder& folder, const std::string& words) {
  folder.write("commands.json", "{\"ur\": " + words + "}");
  std::string text;
  for (const ConfigFault& fault : without_keys(folder.check().faults)) {
    CHECK_FALSE(fault.hint.empty());
    text += fault.key + ": " + fault.what + "\n";
  }
  return text;
}

}  // namespace

TEST_CASE("a pattern: literals, * and {0}, the shortest text that fits") {
  CHECK(taken("0,{{0},{1}},*", "0,{1.5,-2},GetAngle()") == "1.5|-2");
  CHECK(taken("{1} {0}", "a b c") == "b c|a");
  CHECK(taken("OK", "OK").empty());
  CHECK(taken("OK", "OKAY") == "-");
  CHECK(taken("OK*", "OK").empty());
  CHECK(taken("*OK", "NOT OK").empty());
  CHECK(taken("a*a", "a") == "-");
  CHECK(taken("a*b*b", "ab") == "-");
  CHECK(taken("{0}", "all of it") == "all of it");
  CHECK(taken("{x}{0}", "{x}7") == "7");
}

TEST_CASE("a pattern that is none says why") {
  for (const char* bad : {"", "**", "{0}{1}", "*{0}", "{1}", "{0},{0}", "{0},{2}"}) {
    const auto read = Pattern::read(bad);
    REQUIRE_FALSE_MESSAGE(read.ok(), bad);
    CHECK_FALSE(read.error().hint.empty());
  }
  CHECK_FALSE(Pattern::read(std::string(257, 'x')).ok());
}

TEST_CASE("a pattern takes time in proportion to the line") {
  const auto read = Pattern::read("*" + std::string(200, 'a') + "b*");
  REQUIRE(read.ok());
  CHECK_FALSE(read->matches(std::string(65536, 'a')));
}

TEST_CASE("what ends a line: four words, or the text itself") {
  CHECK(*read_text_end("lf") == "\n");
  CHECK(*read_text_end("crlf") == "\r\n");
  CHECK(*read_text_end("cr") == "\r");
  CHECK(*read_text_end("nul") == std::string(1, '\0'));
  CHECK(*read_text_end(";") == ";");
  CHECK(read_text_end("")->empty());
  CHECK_FALSE(read_text_end(std::string(33, ';')).ok());
}

TEST_CASE("answers are read in any pieces, with any end") {
  for (const char* end : {"\n", "\r\n", ";", "END"}) {
    const std::string bytes = std::string("one") + end + end + "two" + end + "thr";
    AnswerReader reader(end);
    std::string read;
    for (const char byte : bytes) {
      const auto some = reader.add(std::string(1, byte));
      REQUIRE(some.ok());
      for (const std::string& answer : *some) read += answer + "|";
    }
    CHECK(read == "one|two|");
    AnswerReader whole(end);
    CHECK(whole.add(bytes)->size() == 2);
  }
}

TEST_CASE("the data of a line without an end are words: a bracket would begin another command") {
  const auto lines = read_dialogue_lines("MovJ({0},{1})", "");
  REQUIRE(lines.ok());
  CHECK(*fill_dialogue_line(lines->front(), "[1, -0.5]", "") == "MovJ(1,-0.5)");
  CHECK(*fill_dialogue_line(lines->front(), R"(["up", true])", "") == "MovJ(up,true)");
  for (const char* data : {R"x(["1)", 2])x", R"(["1)Stop(", 2])", R"(["1,2", 2])", R"(["a b", 2])", R"([";", 2])"}) {
    const auto filled = fill_dialogue_line(lines->front(), data, "");
    REQUIRE_FALSE_MESSAGE(filled.ok(), data);
    CHECK_FALSE(filled.error().hint.empty());
  }
}

TEST_CASE("the data of a line may not have its end in them, also not together with the words") {
  const auto lines = read_dialogue_lines("SAY {0}", "##");
  REQUIRE(lines.ok());
  CHECK(*fill_dialogue_line(lines->front(), R"(["a#b"])", "##") == "SAY a#b");
  for (const char* data : {R"(["a##b"])", R"(["a#"])", R"(["\u0023\u0023"])"})
    CHECK(fill_dialogue_line(lines->front(), data, "##").error().code == Errc::not_escapable);
}

TEST_CASE("commands.json of such a robot is checked: each fault names its key and the cure") {
  const NodeFolder folder("ur");
  CHECK(faults_of(folder, R"x({"transport": "tcp-dialogue", "port": 29999, "line_end": "", "answer_end": ";",
    "greeting": true, "begin": ["EnableRobot()"], "good": ["0,*"], "bad": ["-*"], "ignore": ["x*"], "keep_alive": "P()",
    "keep_alive_s": 2, "timeout_s": 1, "poll_s": 0.2, "hold_s": 1,
    "commands": {"go": "go()", "move": "MovJ({data})", "stop": "Stop()"},
    "values": {"joints": "GetAngle() -> 0,{{0},{1}},*", "robot_mode": "RobotMode() -> 0,{{0}},*"},
    "requests": {"position": "joints"}})x") == "");
  CHECK(faults_of(folder, R"x({"transport": "tcp-dialogue", "line_end": "", "begin": ["Load({0})"], "good": ["{0}"],
    "ignore": ["*"], "keep_alive": "P()", "poll_s": 0.01, "greet": 1,
    "commands": {"go": "GO -> *", "stop": "HALT -> stands"},
    "values": {"joints": "J", "robot_mode": "M -> OK"}, "requests": {"position": "joint"}})x") ==
        "ur.poll_s: 0.01 is out of range\n"
        "ur.greet: is no key that is known here\n"
        "ur.port: is missing: the node dials a port of the robot\n"
        "ur.answer_end: is empty: where an answer ends would not be known\n"
        "ur.begin: 'Load({0})' needs data, and there is none here\n"
        "ur.good: '{0}' would fit anything, or takes a value\n"
        "ur.ignore: '*' would fit anything, or takes a value\n"
        "ur.keep_alive_s: is missing: the other one of the two is there\n"
        "ur.commands.go: '*' is no end of a command\n"
        "ur.commands.stop: ends at a later line, and a stop at its answer\n"
        "ur.values.joints: says not what its answer looks like\n"
        "ur.values.robot_mode: the pattern 'OK' takes nothing from the answer\n"
        "ur.requests.position: 'joint' is no name of \"values\"\n");
}

TEST_CASE("lines that the robot could not take apart, and ends that are none, are refused") {
  for (const char* bad : {"GO\r", "GO ## NOW", "GO#", "A -> B\nC", "GO -> {0}", "GO -> A* else *", " -> A"}) {
    const auto read = read_dialogue_lines(bad, "##");
    REQUIRE_FALSE_MESSAGE(read.ok(), bad);
    CHECK_FALSE(read.error().hint.empty());
  }
  for (const char* bad : {"A", "A -> {0} where x", "A -> {0} where =1", "A -> {0} where x=nan"})
    CHECK_FALSE_MESSAGE(read_dialogue_question(bad, "\n").ok(), std::string(bad));
}

TEST_CASE("an end that waits for a number that no text gets, or for a list, is refused") {
  const auto faults = [](const std::string& value) {
    const NodeFolder folder("ur");
    folder.change("robots/r.json", R"("kind": "acknowledgement")", R"("kind": "state", "state": "m", "equals": 2)");
    return faults_of(folder, R"({"transport": "tcp-dialogue", "port": 1, "commands": {"go": "GO", "stop": "HALT"},
      "values": {"m": ")" + value +
                                 "\"}}");
  };
  CHECK(faults("M -> {0} where DONE=2 BUSY=1").empty());
  CHECK(faults("M -> {0}").empty());
  CHECK(faults("M -> {0} where BUSY=1").find("it gives its texts the numbers BUSY=1") != std::string::npos);
  CHECK(faults("M -> {0} {1}").find("it is a list of 2 values") != std::string::npos);
}
