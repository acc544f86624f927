#include "services/virtual-robots/lines/session.hpp"

#include <doctest/doctest.h>

#include "services/virtual-robots/lines/reports.hpp"

using namespace trb::virtual_robots::lines;

namespace {

using Lines = std::vector<std::string>;

std::vector<std::string> lines_of(Session& session) {
  std::vector<std::string> out;
  for (const SessionEvent& event : session.take_events()) out.push_back(line_of(event));
  return out;
}

/** Only the messages, without their fields. */
std::vector<Message> messages_of(Session& session) {
  std::vector<Message> out;
  for (const SessionEvent& event : session.take_events()) {
    if (const auto* received = std::get_if<MessageReceived>(&event)) out.push_back(received->message);
  }
  return out;
}

SessionSettings numeric_settings() {
  SessionSettings settings;
  settings.vocabulary.numeric = true;
  for (const char* code : {"subtype:go_to=7", "subtype:done=1", "id:ur3=2"}) settings.vocabulary.codes.add(code);
  return settings;
}

}  // namespace

TEST_CASE("session: a message of five fields, each acknowledged") {
  Session session({});
  session.receive("command\ngo_to\nscheduler\n5\n1 2 3\n", 0);
  CHECK(lines_of(session) == Lines{"field 1 command", "field 2 go_to", "field 3 scheduler", "field 4 5",
                                   "field 5 1 2 3", "message command go_to scheduler 5 1 2 3"});
  CHECK(session.take_output(0) == "ok\nok\nok\nok\nok\n");
}

TEST_CASE("session: no acknowledgement where the robot cannot") {
  SessionSettings settings;
  settings.acknowledge = false;
  Session session(settings);
  session.receive("request\nposition\nui\n0\n\n", 0);
  CHECK(messages_of(session) == std::vector<Message>{{"request", "position", "ui", ""}});
  CHECK(session.take_output(0).empty());
}

TEST_CASE("session: chunks are collected until the size is reached, byte by byte as well") {
  const std::string bytes = "information\nnote\nur3\n6\na\\nb\n\\\\cd\ncommand\nhome\n\n0\n\n";
  const std::vector<Message> expected{{"information", "note", "ur3", "a\nb\\cd"}, {"command", "home", "", ""}};
  Session whole({});
  whole.receive(bytes, 0);
  CHECK(messages_of(whole) == expected);
  Session bytewise({});
  for (const char byte : bytes) bytewise.receive({&byte, 1}, 0);
  CHECK(messages_of(bytewise) == expected);
  CHECK(bytewise.take_output(0) == whole.take_output(0));
}

TEST_CASE("session: the length framing carries the same messages") {
  SessionSettings settings;
  settings.frame.framing = Framing::length;
  Session session(settings);
  std::string bytes;
  for (const char* field : {"command", "say", "ui", "3", "a\nb"}) bytes += frame_field(field, settings.frame);
  session.receive(bytes, 0);
  CHECK(messages_of(session) == std::vector<Message>{{"command", "say", "ui", "a\nb"}});
  CHECK(session.take_output(0).substr(0, 6) == std::string("\0\0\0\2ok", 6));
}

TEST_CASE("session: the delay framing spaces what it sends and cannot see an empty chunk") {
  SessionSettings settings;
  settings.frame = {Framing::delay, 0.010, 0};
  settings.acknowledge = false;
  settings.own_name = "ridgeback";
  Session session(settings);
  double now = 0;
  for (const char* field : {"request", "position", "ui", "0"}) session.receive(field, now += 0.010);
  CHECK(session.next_deadline() == doctest::Approx(now + 0.005));
  session.advance(now += 0.005);
  CHECK(messages_of(session) == std::vector<Message>{{"request", "position", "ui", ""}});
  session.send({"information", "done", "", "go_to"});
  Lines sent;
  for (int i = 0; i < 5; ++i, now += 0.010) {
    sent.push_back(session.take_output(now));
    CHECK(session.take_output(now + 0.009).empty());
  }
  CHECK(sent == Lines{"information", "done", "ridgeback", "5", "go_to"});
}

TEST_CASE("session: with the delay framing fields that come without a pause melt together") {
  SessionSettings settings;
  settings.frame = {Framing::delay, 0.010, 0};
  Session session(settings);
  session.receive("command", 0);
  session.receive("go_to", 0.001);
  session.advance(1);
  CHECK(session.fault() == "bad_type");
}

TEST_CASE("session: stop in the middle of a message throws its part away") {
  Session session({});
  session.receive("command\ngo_to\nui\n5\n1 2\n!stop\n", 0);
  CHECK(lines_of(session).back() == "stopped");
  CHECK(session.take_output(0) == "ok\nok\nok\nok\nok\n!stopped\n");
  session.receive("command\ngo_to\n!stop\n!stop\nrequest\nbattery\nui\n0\n\n!release\n", 0);
  const Lines lines = lines_of(session);
  CHECK(lines == Lines{"field 1 command", "field 2 go_to", "stopped", "stopped", "field 1 request", "field 2 battery",
                       "field 3 ui", "field 4 0", "field 5 ", "message request battery ui 0 ", "released"});
  CHECK(session.take_output(0) == "ok\nok\n!stopped\n!stopped\nok\nok\nok\nok\nok\n!released\n");
}

TEST_CASE("session: a message of its own, in chunks") {
  SessionSettings settings;
  settings.frame.chunk_bytes = 4;
  Session session(settings);
  session.send({"information", "note", "ur3", "abcdef"});
  CHECK(session.take_output(0) == "information\nnote\nur3\n6\nabcd\nef\n");
}

TEST_CASE("session: the numeric encoding, in both directions") {
  Session session(numeric_settings());
  session.receive("1\n7\n2\n5\n1 2 3\n-1\n-2\n2\n9\n0\n0\n\n", 0);
  const Lines lines = lines_of(session);
  CHECK(lines[5] == "message command go_to ur3 5 1 2 3");
  CHECK(lines[6] == "stopped");
  CHECK(lines[7] == "released");
  CHECK(lines.back() == "message request 9 - 0 ");
  CHECK(session.take_output(0) == "0\n0\n0\n0\n0\n-1\n-2\n0\n0\n0\n0\n0\n");
  session.send({"information", "done", "", "7"});
  CHECK(session.take_output(0) == "3\n1\n0\n1\n7\n");
  session.send({"information", "unheard", "", "7"});
  CHECK(lines_of(session) == Lines{"violation no_code subtype:unheard"});
  CHECK(session.take_output(0).empty());
}

TEST_CASE("session: a line longer than the robot's strings is told and still read") {
  SessionSettings settings;
  settings.frame.chunk_bytes = 11;
  Session session(settings);
  session.receive("information\nnote\nui\n12\nabcdefghijkl\n", 0);
  const Lines lines = lines_of(session);
  CHECK(lines[4] == "violation line_too_long");
  CHECK(lines.back() == "message information note ui 12 abcdefghijkl");
}

TEST_CASE("session: what cannot be understood ends the connection") {
  const std::vector<std::pair<std::string, std::string>> cases = {
      {"dance\n", "bad_type"},
      {"command\na\nb\nmany\n", "bad_size"},
      {"command\na\nb\n-1\n", "bad_size"},
      {"command\na\nb\n99999999999\n", "message_too_long"},
      {"command\na\nb\n2\nabc\n", "size_mismatch"},
      {std::string(kLargestField + 1, 'x'), "field_too_long"},
  };
  for (const auto& [bytes, fault] : cases) {
    Session session({});
    session.receive(bytes, 0);
    CHECK(session.fault() == fault);
    session.restart();
    session.take_events();
    session.receive("command\nhome\n\n0\n\n", 0);
    CHECK(messages_of(session).size() == 1);
  }
}

TEST_CASE("session: output that the node does not read is bounded") {
  Session session({});
  const std::string data(std::size_t{1024} * 1024, 'x');
  for (int i = 0; i < 5; ++i) session.send({"information", "note", "", data});
  CHECK(session.fault() == "node_does_not_read");
}

TEST_CASE("session: after its last message it reads nothing any more") {
  SessionSettings settings;
  settings.hang_after = 1;
  Session session(settings);
  session.receive("command\nhome\n\n0\n\ncommand\n", 0);
  CHECK(session.hung());
  session.receive("!stop\n", 0);
  CHECK(lines_of(session).back() == "message command home - 0 ");
  CHECK(session.take_output(0) == "ok\nok\nok\nok\nok\n");
}
