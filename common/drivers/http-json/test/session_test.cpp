// A robot with sessions, as an ABB with RobotWare 6: a sign-in by Digest, cookies, forms, numbers as texts, mastership.
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

constexpr const char* kMaster = "POST /rw/mastership/rapid?action=";
constexpr const char* kSet = "POST /rw/rapid/symbol/data/";

Settings rws() {
  Settings settings = robot_settings("abb", "abb", Mode::direct, "http-json");
  settings.host = "10.0.0.8";
  settings.authorization = "Digest Default User:robotics";
  settings.description.capabilities = {"reach"};
  settings.commands.port = 80;
  settings.commands.numbers["cookies"] = 1;
  settings.commands.texts["body"] = {"form"};
  settings.commands.texts["sign_out"] = {"GET /logout"};
  settings.commands.texts["headers"] = {"Accept:application/hal+json;v=2.0", "X-Key:k1"};
  settings.commands.values = {{"joints", "GET /joints?json=1 /s/rax_1 number /s/rax_2 number"},
                              {"busy", "GET /busy /v TRUE=1 FALSE=0"}};
  settings.commands.commands = {{"move", std::string(kMaster) + "request\n" + kSet +
                                             "{0}?action=set value=[{1},{2}]\nalways " + kMaster + "release"},
                                {"say", std::string(kSet) + "text?action=set value=%22{data}%22"},
                                {"stop", "POST /stop stopmode=stop"},
                                {"release", ""}};
  settings.commands.requests = {{"joints", "joints"}, {"busy", "busy"}};
  return settings;
}

struct Rws : Fixture {
  explicit Rws(Settings settings = rws()) : Fixture(std::move(settings)) {}

  /// The request since the last look: "POST /stop stopmode=stop".
  std::string asked() {
    const std::string bytes = written(Channel::command);
    if (bytes.empty()) return {};
    const std::size_t head = bytes.find("\r\n\r\n");
    REQUIRE(head != std::string::npos);
    header = bytes.substr(0, head + 2);
    const std::string body = bytes.substr(head + 4);
    return bytes.substr(0, bytes.find(" HTTP/1.1\r\n")) + (body.empty() ? "" : " " + body);
  }
  /// A field of the last request's header; empty: it has none.
  [[nodiscard]] std::string field(const std::string& name) const {
    const std::size_t at = header.find("\r\n" + name + ": ");
    if (at == std::string::npos) return {};
    const std::size_t begin = at + name.size() + 4;
    return header.substr(begin, header.find("\r\n", begin) - begin);
  }
  void answer_with(int status, const std::string& body = "", const std::string& more = "") {
    hear(Channel::command, "HTTP/1.1 " + std::to_string(status) +
                               " X\r\nContent-Length: " + std::to_string(body.size()) + "\r\n" + more + "\r\n" + body);
  }
  void challenge() {
    answer_with(401, "",
                "WWW-Authenticate: Digest realm=\"validusers@robapi.abb\", domain=\"/\", qop=\"auth\", nonce=\"n" +
                    std::to_string(++nonces) + "\", algorithm=\"MD5\"\r\n");
  }
  /// The polls of a round are answered; returns what else was asked, unanswered.
  std::string serve_polls() {
    for (;;) {
      const std::string what = asked();
      if (what == "GET /joints?json=1") {
        answer_with(200, R"({"s": {"rax_1": "1.5", "rax_2": "-2"}})", "Set-Cookie: -http-session-=7; path=/\r\n");
      } else if (what == "GET /busy") {
        answer_with(200, R"({"v": "FALSE"})");
      } else {
        return what;
      }
    }
  }
  std::string robot() {
    deliver(MessageType::request, AdapterStateRequest{}, "abb");
    return get<AdapterState>(told<AdapterState>().back().body).robot;
  }

  std::string header;
  int nonces = 0;
};

struct OnlineRws : Rws {
  OnlineRws() {
    up(Channel::command);
    asked();
    challenge();
    CHECK(serve_polls().empty());
    CHECK(robot() == "ONLINE");
  }
};

}  // namespace

TEST_CASE("the first challenge is answered, and counts as nothing; the password is in no log") {
  Rws fixture;
  fixture.up(Channel::command);
  CHECK(fixture.asked() == "GET /busy");
  CHECK(fixture.field("Authorization").empty());
  fixture.challenge();
  CHECK(fixture.told<RobotFault>().empty());
  CHECK(fixture.asked() == "GET /busy");
  CHECK(
      fixture.field("Authorization").starts_with("Digest username=\"Default User\", realm=\"validusers@robapi.abb\""));
  CHECK(fixture.field("Accept") == "application/hal+json;v=2.0");
  CHECK(fixture.field("X-Key") == "k1");
  fixture.answer_with(200, R"({"v": "FALSE"})");
  CHECK(fixture.serve_polls().empty());
  CHECK(fixture.robot() == "ONLINE");
  CHECK(fixture.field("Authorization").find("nc=00000002") != std::string::npos);
  CHECK(fixture.answer(fixture.send(MessageType::request, "joints", "")) == "[1.5,-2]");
  CHECK(fixture.counted("to_robot.sign_in") == 1);
  for (const auto& log : fixture.out.logs) CHECK(log.text.find("robotics") == std::string::npos);
}

TEST_CASE("a robot that ends the connection with its challenge is dialled again, and asked the same") {
  Rws fixture;
  fixture.up(Channel::command);
  CHECK(fixture.asked() == "GET /busy");
  fixture.answer_with(401, "", "Connection: close\r\nWWW-Authenticate: Digest realm=\"r\", nonce=\"n\"\r\n");
  CHECK(fixture.closed() == "the robot ends each connection;");
  CHECK(fixture.asked().empty());
  fixture.up(Channel::command);
  CHECK(fixture.asked() == "GET /busy");
  CHECK(fixture.field("Authorization").starts_with("Digest "));
  CHECK(fixture.told<RobotConnection>().empty());
}

TEST_CASE("a wrong password is refused once the challenge was answered, without another try for each poll") {
  Rws fixture;
  fixture.up(Channel::command);
  fixture.asked();
  fixture.challenge();
  CHECK(fixture.asked() == "GET /busy");
  fixture.challenge();  // the password is wrong
  CHECK(fixture.asked() == "GET /joints?json=1");
  fixture.challenge();
  CHECK(fixture.asked().empty());
  CHECK(fixture.robot() != "ONLINE");
  const auto id = fixture.command("say", "\"x\"");
  CHECK(fixture.nack_of(id).what.find("the robot refuses the sign-in and asks for Digest") != std::string::npos);
  for (const auto& log : fixture.out.logs) CHECK(log.text.find("robotics") == std::string::npos);
}

TEST_CASE("a nonce that is outdated under a stop is answered, and the stop is sent again before all else") {
  OnlineRws fixture;
  const auto move = fixture.command("move", R"(["target", 1, 2])");
  CHECK(fixture.asked() == std::string(kMaster) + "request");
  fixture.challenge();
  CHECK(fixture.asked() == std::string(kMaster) + "request");
  const auto stop = fixture.deliver(MessageType::command, Stop{"a person"});
  CHECK(fixture.answer(move) == "nack fenced");
  fixture.answer_with(204);
  CHECK(fixture.asked() == "POST /stop stopmode=stop");
  CHECK(fixture.field("Content-Type") == "application/x-www-form-urlencoded");
  fixture.challenge();
  CHECK(fixture.asked() == "POST /stop stopmode=stop");
  fixture.answer_with(204);
  fixture.wait(0);
  CHECK(fixture.answer(stop) == "ack stopped");
  CHECK(fixture.asked() == std::string(kMaster) + "release");  // what was begun is tidied up
}

TEST_CASE("a line that is always sent follows a refusal, which is answered at once") {
  OnlineRws fixture;
  const auto id = fixture.command("move", R"(["a b", 1, 2])");
  CHECK(fixture.asked() == std::string(kMaster) + "request");
  fixture.answer_with(204);
  CHECK(fixture.asked() == std::string(kSet) + "a%20b?action=set value=[1,2]");
  fixture.answer_with(400, "no such symbol");
  CHECK(fixture.nack_of(id).what.find("was answered with 400: no such symbol; the 1 requests before it") !=
        std::string::npos);
  const auto next = fixture.command("say", "\"x\"");
  CHECK(fixture.asked() == std::string(kMaster) + "release");
  fixture.answer_with(403, "not the holder");
  CHECK(fixture.counted("refused.robot_error") == 2);  // of the command, and of this line
  CHECK(fixture.asked() == std::string(kSet) + "text?action=set value=%22x%22");
  fixture.answer_with(204);
  CHECK(fixture.answer(next) == "ack handed_over");
}

TEST_CASE("without a refusal it is the last line, and ends the command") {
  OnlineRws fixture;
  const auto id = fixture.command("move", R"(["t", 1, 2])");
  for (int i = 0; i < 2; ++i) {
    fixture.asked();
    fixture.answer_with(204);
  }
  CHECK(fixture.asked() == std::string(kMaster) + "release");
  CHECK(fixture.answer(id).empty());
  fixture.answer_with(204);
  CHECK(fixture.answer(id) == "ack handed_over");
}

TEST_CASE("data cannot end a form or lead to another path") {
  OnlineRws fixture;
  fixture.command("say", R"("a&b=c\" ö%")");
  CHECK(fixture.asked() == std::string(kSet) + "text?action=set value=%22a%26b%3Dc%22%20%C3%B6%25%22");
  fixture.answer_with(204);
  for (const char* name : {R"("..")", R"(".")", R"("")", R"("a/b")", R"("a\\b")"}) {
    const auto id = fixture.command("move", "[" + std::string(name) + ", 1, 2]");
    CHECK(fixture.nack_of(id).code == "not_escapable");
    CHECK(fixture.nack_of(id).what.find("would lead to another path") != std::string::npos);
  }
  CHECK(fixture.answer(fixture.command("move", R"([[1], 1, 2])")) == "nack bad_value");
  CHECK(fixture.asked().empty());
}

TEST_CASE("the session's cookie goes with each request, until the sign-in is refused; a node that ends signs out") {
  OnlineRws fixture;
  CHECK(fixture.field("Cookie").empty());
  fixture.core.leave(fixture.now, fixture.out);
  CHECK(fixture.asked() == "GET /logout");
  CHECK(fixture.field("Cookie") == "-http-session-=7");
  fixture.wait(0.5);
  fixture.asked();
  fixture.challenge();
  CHECK(fixture.asked() == "GET /busy");
  CHECK(fixture.field("Cookie") == "-http-session-=7");
  fixture.challenge();
  CHECK(fixture.asked() == "GET /joints?json=1");
  CHECK(fixture.field("Cookie").empty());
}

TEST_CASE("a text that is no number where one is expected is a problem, not another number's place") {
  OnlineRws fixture;
  for (const char* bad : {R"({"s": {"rax_1": "1.5", "rax_2": "x"}})", R"({"s": {"rax_1": "1.5", "rax_2": "inf"}})",
                          R"({"s": {"rax_1": "1.5", "rax_2": ""}})", R"({"s": {"rax_1": "1.5", "rax_2": null}})"}) {
    fixture.wait(0.5);
    CHECK(fixture.asked() == "GET /busy");
    fixture.answer_with(200, R"({"v": "TRUE"})");
    CHECK(fixture.asked() == "GET /joints?json=1");
    fixture.answer_with(200, bad);
    const auto id = fixture.send(MessageType::request, "joints", "");
    CHECK(fixture.nack_of(id).what.find("what stands at /s/rax_2 is no number") != std::string::npos);
  }
  CHECK(fixture.answer(fixture.send(MessageType::request, "busy", "")) == "\"TRUE\"");
}
