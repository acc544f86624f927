// Messages: their fields, acknowledgements, framing, data.
#include "services/cli/conform/cases.hpp"

namespace trb::cli::conform {
namespace {

constexpr Duration kFieldMoment = std::chrono::milliseconds(100);
constexpr std::size_t kPieces = 40;  ///< a slow sender's writes a field, at most

bool text_only(Play& play) {
  if (play.words().numeric()) play.not_tried("the robot speaks in numbers");
  return !play.words().numeric();
}

void connects(Play&) {}

void acknowledges(Play& play) {
  if (!play.acknowledged()) return play.not_tried("\"acknowledge\" is false");
  const auto fields = play.fields("information", play.settings().echo, play.words().numeric() ? "1" : "x");
  for (std::size_t i = 0; i < fields.size() && play.going(); ++i) {
    play.expect_quiet(kFieldMoment, "no acknowledgement but one after each field");
    play.raw(fields[i]);
    play.expect_ok("field " + std::to_string(i + 1) + " of a message");
  }
  play.expect_quiet(kFieldMoment, "no acknowledgement but one after each field");
}

void acknowledges_nothing(Play& play) {
  if (play.acknowledged()) return play.not_tried("\"acknowledge\" is true");
  play.send("information", play.settings().echo, play.words().numeric() ? "1" : "x");
  play.expect_quiet(2 * kFieldMoment, "no acknowledgement: the description says \"acknowledge\": false");
}

void answers(Play& play) {
  play.expect_answers();
}

void answers_unknown(Play& play) {
  const auto& codes = play.settings().channel.subtype_codes;
  if (play.words().numeric() && !codes.contains("conform_unknown")) {
    return play.not_tried("\"conform_unknown\" has no number in field_channel.codes.subtypes");
  }
  play.send("request", "conform_unknown", "");
  play.expect_answer("conform_unknown", play.words().unknown());
  play.still_understands();
}

void takes_unknown(Play& play) {
  const std::string subtype = play.words().numeric() ? "done" : "conform_unknown";
  play.send("command", subtype, play.words().numeric() ? "1 2" : "some data");
  play.still_understands();
}

void information(Play& play) {
  play.send("information", play.settings().echo, play.words().numeric() ? "5" : "not to be answered");
  play.still_understands();
}

void empty(Play& play) {
  play.echo("");
  play.still_understands();
}

void escapes(Play& play) {
  if (!text_only(play)) return;
  play.echo("back\\slash");
  play.echo("two\nlines\r\n");
  play.echo("\\n is no line end, \\\\ no backslash, \\");
  play.echo("\n");
}

void utf8(Play& play) {
  if (!text_only(play)) return;
  play.echo("Gr\u00fc\u00dfe \u2013 \u673a\u5668\u4eba \U0001F916");
}

void quotes(Play& play) {
  if (!text_only(play)) return;
  play.echo("say \"stop\" and 'go'; \t {data} %s ok");
}

void numbers(Play& play) {
  if (!play.words().numeric()) return play.not_tried("the robot speaks in text");
  play.echo("1 -2.5 3e2 0");
  play.echo("-1.0");
}

void chunks(Play& play) {
  const std::size_t most = play.settings().channel.chunk_bytes;
  if (most == 0) return play.not_tried("\"chunk_bytes\" is 0: nothing is cut");
  std::string data;
  while (data.size() < 3 * most) data += play.words().numeric() ? "1.25 -7 " : "a part with a \\ in it, ";
  if (play.words().numeric()) data.pop_back();
  play.echo(data);
  play.still_understands();
}

void looks_like_orders(Play& play) {
  // The node cuts such data into two chunks, whatever chunk_bytes is.
  if (!text_only(play)) return;
  play.echo("!stop");
  play.echo("!release");
  play.echo("ok");
}

void large(Play& play) {
  const std::size_t size = play.settings().large;
  if (size == 0) return play.not_tried("--large 0");
  const std::string part = play.words().numeric() ? "12345.5 " : "0123456789 ";
  std::string data;
  while (data.size() + part.size() <= size) data += part;
  if (play.words().numeric() && !data.empty()) data.pop_back();
  play.echo(data);
  play.still_understands();
}

/// Writes a field in pieces, each in a packet of its own.
void write_slowly(Play& play, const std::string& field) {
  const std::size_t step = field.size() / kPieces + 1;
  for (std::size_t at = 0; at < field.size() && play.going(); at += step) {
    play.raw(field.substr(at, step));
    pause(std::chrono::milliseconds(5));
  }
}

void slow_sender(Play& play) {
  if (play.delayed()) return play.not_tried("a pause ends a field");
  const std::string data = play.words().numeric() ? "314 159" : "slowly, \\ byte by byte";
  for (const std::string& field : play.fields("request", play.settings().echo, data)) {
    write_slowly(play, field);
    if (play.acknowledged()) play.expect_ok("a field that came byte by byte");
  }
  play.expect_answer(play.settings().echo, data);
}

void back_to_back(Play& play) {
  const std::string& echo = play.settings().echo;
  const std::string one = play.words().numeric() ? "1" : "one", two = play.words().numeric() ? "2" : "two";
  if (play.delayed() || play.acknowledged()) {
    play.send("request", echo, one);
    play.send("request", echo, two);
  } else {
    play.send_at_once({play.fields("request", echo, one), play.fields("request", echo, two)});
  }
  play.expect_answer(echo, one);
  play.expect_answer(echo, two);
}

/// The next message begins before the robot has said the whole of its answer.
void while_it_talks(Play& play) {
  const std::string& echo = play.settings().echo;
  std::string data;
  while (data.size() < 4000) data += play.words().numeric() ? "42 " : "a long answer ";
  if (play.words().numeric()) data.pop_back();
  const std::string last = play.words().numeric() ? "3" : "the next";
  play.send("request", echo, data);
  play.send("request", echo, last);
  play.expect_answer(echo, data);
  play.expect_answer(echo, last);
}

/// For cases that need a robot that shows what it has taken.
template <void (*Then)(Play&)>
void with_echo(Play& play) {
  play.echo(play.words().numeric() ? "1" : "before");
  if (play.going()) Then(play);
}

}  // namespace

std::vector<Case> field_cases() {
  return {
      {"connect", "the robot dials its node", "A new connection", connects},
      {"acknowledge", "one acknowledgement after each field, and no other", "Acknowledgement", acknowledges},
      {"no-acknowledge", "no acknowledgement, where none is wanted", "Acknowledgement", acknowledges_nothing},
      {"answer", "a request is answered to who asked, its fields in their order", "Answers", answers},
      {"unknown-request", "a request of an unknown subtype is answered, too", "Answers", answers_unknown},
      {"unknown-command", "a command of an unknown subtype is taken and does no harm", "Answers", takes_unknown},
      {"information", "an information is taken and not answered", "Answers", information},
      {"empty", "empty data is one empty chunk", "Framing", empty},
      {"escapes", "backslashes and line ends in data", "Framing", escapes},
      {"quotes", "quotes, tabs and placeholders in data", "Framing", quotes},
      {"utf8", "the size counts bytes, not characters", "Framing", utf8},
      {"numbers", "numbers in data", "Grammar", numbers},
      {"chunks", "data is collected from several chunks, and sent in several", "Framing", chunks},
      {"like-an-order", "data that reads as an order, in two chunks", "Framing", looks_like_orders},
      {"large", "a message of 1 MB", "Framing", large},
      {"slow-sender", "a field that comes byte by byte", "Framing", with_echo<slow_sender>},
      {"back-to-back", "two messages, the second at once after the first", "Grammar", with_echo<back_to_back>},
      {"while-it-talks", "no acknowledgement within the robot's own message", "Acknowledgement",
       with_echo<while_it_talks>},
  };
}

std::vector<Case> all_cases() {
  std::vector<Case> out = field_cases();
  for (const Case& one : order_cases()) out.push_back(one);
  return out;
}

}  // namespace trb::cli::conform
