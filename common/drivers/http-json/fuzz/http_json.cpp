// What a robot with a REST interface answers: whole and in pieces, and the driver behind, with commands and a stop
// under way.
#include "common/drivers/http-json/cookies.hpp"
#include "common/drivers/http-json/digest.hpp"
#include "common/drivers/http-json/syntax.hpp"
#include "common/drivers/http-json/wire.hpp"
#include "tests/fuzz/adapter_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::adapter;

Settings settings() {
  Settings out = robot_settings("mir", Mode::direct, "http-json", "mobile");
  out.commands.commands = {
      {"go", "POST /q {\"id\": {data}} -> q /id\nGET /q/<q>"}, {"stop", "PUT /s {}"}, {"release", ""}};
  out.commands.values = {{"position", "GET /s /x /y"}, {"state", "GET /q/<q> /state Done=1"}};
  out.commands.requests = {{"position", "position"}, {"state", "state"}};
  return out;
}

/// The same with a sign-in by Digest, cookies and forms.
Settings with_sessions() {
  Settings out = settings();
  out.authorization = "Digest nobody:geheim";
  out.commands.numbers["cookies"] = 1;
  out.commands.texts = {{"body", {"form"}}, {"headers", {"X-Key:1"}}};
  out.commands.commands = {
      {"go", "POST /q/{data} id={data} -> q /id\nGET /q/<q>\nalways PUT /s"}, {"stop", "PUT /s a=b"}, {"release", ""}};
  out.commands.values["joints"] = "GET /s /x number /y number";
  return out;
}

/// Every byte that goes to the robot is a request, and there is one at a time.
void check_writes(const RobotOutbox& out) {
  for (const RobotWrite& write : out.writes) {
    const bool line =
        write.bytes.starts_with("GET /") || write.bytes.starts_with("POST /") || write.bytes.starts_with("PUT /");
    const std::size_t head = write.bytes.find("\r\n\r\n");
    require(line && head != Bytes::npos, "what is written is a request");
    require(write.bytes.find("\r\n\r\n", head + 1) == Bytes::npos, "no text ends a header");
    require(write.bytes.find("geheim") == Bytes::npos, "a password is never written");
  }
  require(out.writes.size() <= 1 || out.closes.size() + 1 >= out.writes.size(), "one request at a time");
}

void converse(BytesView input, Settings how) {
  AdapterUnderTest adapter(std::move(how));
  adapter.connect(Channel::command);
  adapter.hear(Channel::command, "HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n{}");
  adapter.order({MessageType::command, "operator", "mir", 1, 0, 0, 5000, Opaque{"go", "1"}});
  std::vector<Send> sends = adapter.out.sends;
  static_cast<void>(adapter.core.take_robot_output());
  while (!input.empty()) {
    adapter.out = {};
    adapter.hear(Channel::command, input.substr(0, 40));
    input.remove_prefix(std::min<std::size_t>(40, input.size()));
    const RobotOutbox robot = adapter.core.take_robot_output();
    check_writes(robot);
    sends.insert(sends.end(), adapter.out.sends.begin(), adapter.out.sends.end());
    if (!robot.closes.empty()) {
      adapter.core.on_channel_down(Channel::command, "closed", adapter.now, adapter.out);
      adapter.connect(Channel::command);
    }
    adapter.pass(std::chrono::milliseconds(110));
    sends.insert(sends.end(), adapter.out.sends.begin(), adapter.out.sends.end());
  }
  adapter.out = {};
  adapter.pass(std::chrono::seconds(20));
  adapter.pass({});
  require(adapter.core.next_deadline() > adapter.now.mono || !adapter.core.next_deadline(), "nothing stays due");
}

}  // namespace

std::vector<Bytes> seeds() {
  return {
      "HTTP/1.1 201 Created\r\nContent-Length: 9\r\n\r\n{\"id\": 7}HTTP/1.1 200 OK\r\nContent-Length: "
      "17\r\n\r\n{\"state\": \"Done\"}",
      "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n4\r\n{\"x\"\r\n4\r\n: 1}\r\n0\r\n\r\n",
      "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n",
      "HTTP/1.0 404 Not Found\r\n\r\n{}",
      "HTTP/1.1 204 No Content\r\nConnection: close\r\n\r\n",
      "HTTP/1.1 401 X\r\nWWW-Authenticate: Digest realm=\"a\\\"b\", qop=\"auth,auth-int\", nonce=\"n\", "
      "algorithm=SHA-256, Basic\r\n"
      "Set-Cookie: -http-session-=1::x; path=/\r\nContent-Length: 0\r\n\r\nHTTP/1.1 200 OK\r\nContent-Length: "
      "20\r\n\r\n"
      "{\"x\": \"1\",\"y\":\"-2e1\"}"};
}

void run(BytesView input) {
  HttpReader one;
  HttpReader two;
  std::vector<HttpAnswer> pieces;
  bool good = true;
  for (std::size_t i = 0; i < input.size() && good; ++i) {
    auto some = two.add(input.substr(i, 1));
    good = some.ok();
    for (HttpAnswer& answer : good ? *some : std::vector<HttpAnswer>()) pieces.push_back(std::move(answer));
  }
  if (const auto whole = one.add(input)) {
    require(whole->size() <= pieces.size() + 1, "pieces read as the whole");
    for (std::size_t i = 0; i < std::min(whole->size(), pieces.size()); ++i) {
      require((*whole)[i].status == pieces[i].status && (*whole)[i].body == pieces[i].body, "pieces read as the whole");
      require(pieces[i].body.size() <= HttpReader::kMaxBody, "a body is bounded");
    }
  }
  DigestSignIn sign_in("nobody:geheim", 1);
  const std::string value(input.substr(0, 2000));
  if (sign_in.on_refused({value})) {
    const std::string answer = sign_in.authorize("GET", "/s");
    require(answer.starts_with("Digest username=\"nobody\", ") && answer.size() < 6000, "a challenge is answered");
  }
  CookieJar jar;
  jar.take({value, value});
  require(jar.size() <= 1 && jar.header().find_first_of("\r\n") == std::string::npos, "a cookie ends no header");
  const auto form = read_http_calls(std::string(input), HttpBody::form);
  require(form.ok() || !form.error().what.empty(), "a refused line says why");
  const auto words = read_http_calls(std::string(input));
  require(words.ok() || !words.error().what.empty(), "a refused line says why");
  const auto question = read_http_question(std::string(input));
  require(question.ok() || !question.error().what.empty(), "a refused value says why");
  converse(input, settings());
  converse(input, with_sessions());
}

}  // namespace trb::fuzz
