#include "common/drivers/http-json/wire.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::drivers;

namespace {

const std::string kTwo =
    "HTTP/1.1 100 Continue\r\n\r\n"
    "HTTP/1.1 201 Created\r\nTransfer-Encoding: chunked\r\n\r\n4\r\n{\"id\r\n5\r\n\": 7}\r\n0\r\n\r\n"
    "HTTP/1.1 204 No Content\r\nConnection: close\r\n\r\n";

}  // namespace

TEST_CASE("answers are the same however the stream is cut") {
  for (std::size_t step = 1; step <= kTwo.size(); ++step) {
    HttpReader reader;
    std::vector<HttpAnswer> got;
    for (std::size_t at = 0; at < kTwo.size(); at += step) {
      auto some = reader.add(BytesView(kTwo).substr(at, step));
      REQUIRE(some.ok());
      for (HttpAnswer& answer : *some) got.push_back(std::move(answer));
    }
    REQUIRE(got.size() == 2);
    CHECK(got[0].status == 201);
    CHECK(got[0].body == R"({"id": 7})");
    CHECK_FALSE(got[0].closes);
    CHECK(got[1].status == 204);
    CHECK(got[1].closes);
    CHECK(reader.end().empty());
  }
}

TEST_CASE("an answer in chunks is read however its last chunk is cut, and a broken one gives no answer") {
  const std::string empty = "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n\r\n";
  const std::string wrong = "HTTP/1.1 200 OK\r\nTransfer-Encoding: chunked\r\n\r\n0\r\n{\"x\"\r\n4\r\r\n";
  for (std::size_t step = 1; step <= wrong.size(); ++step) {
    HttpReader reader;
    std::size_t answers = 0;
    for (std::size_t at = 0; at < empty.size(); at += step)
      answers += reader.add(BytesView(empty).substr(at, step))->size();
    CHECK(answers == 1);
    bool good = true;
    for (std::size_t at = 0; at < wrong.size() && good; at += step)
      good = reader.add(BytesView(wrong).substr(at, step)).ok();
    CHECK(reader.end().empty());
  }
}

TEST_CASE("an answer without a length ends with the connection; half of one is none") {
  HttpReader reader;
  CHECK(reader.add("HTTP/1.0 200 OK\r\n\r\n{\"a\"")->empty());
  CHECK(reader.add(": 1}")->empty());
  const auto last = reader.end();
  REQUIRE(last.size() == 1);
  CHECK(last[0].body == "{\"a\": 1}");
  CHECK(reader.add("HTTP/1.1 200 OK\r\nContent-Length: 5\r\n\r\n{}")->empty());
  CHECK(reader.end().empty());
  CHECK(reader.add("HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n{}")->size() == 1);
}

TEST_CASE("what is no HTTP, and what is too large, is refused") {
  const auto refusal = [](const std::string& bytes) {
    HttpReader reader;
    const auto answers = reader.add(bytes);
    return answers ? Errc{} : answers.error().code;
  };
  CHECK(refusal("SSH-2.0-OpenSSH_9.2\r\n\r\n") == Errc::malformed);
  CHECK(refusal("HTTP/1.1 200 OK\r\nContent-Length: x\r\n\r\n") == Errc::malformed);
  CHECK(refusal("HTTP/1.1 200 OK\r\nContent-Length: 2000000\r\n\r\n{}") == Errc::too_large);
  CHECK(refusal("HTTP/1.1 200 OK\r\nX: " + std::string(20'000, 'x')) == Errc::too_large);
}

TEST_CASE("a port that speaks TLS is told from one that speaks nonsense") {
  HttpReader reader;
  const auto answers = reader.add(std::string("\x15\x03\x03\x00\x02\x02\x46", 7));
  REQUIRE_FALSE(answers);
  CHECK(answers.error().what == "TLS: the robot's port speaks it, and commands.json has no \"tls\"");
  CHECK(answers.error().hint.starts_with("trb robot certificate NODE_DIR"));
}

TEST_CASE("a request has a length if it has a body or may have one") {
  const HttpFields fields{{"Host", "h"}, {"Accept", "application/json"}};
  CHECK(encode(HttpRequest{"GET", "/a", ""}, fields) ==
        "GET /a HTTP/1.1\r\nHost: h\r\nAccept: application/json\r\n\r\n");
  CHECK(encode(HttpRequest{"DELETE", "/a", ""}, fields).ends_with("\r\nContent-Length: 0\r\n\r\n"));
  CHECK(encode(HttpRequest{"PUT", "/a", "{}"}, fields).ends_with("\r\nContent-Length: 2\r\n\r\n{}"));
}

TEST_CASE("an answer keeps its challenges and its cookies, each as often as it has one") {
  HttpReader reader;
  const auto got = reader.add(
      "HTTP/1.1 401 X\r\nWWW-Authenticate: Basic realm=\"a\"\r\nwww-authenticate: Digest nonce=\"b\"\r\n"
      "Set-Cookie: a=1; path=/\r\nSet-Cookie: b=2\r\nContent-Length: 0\r\n\r\n");
  REQUIRE(got.ok());
  REQUIRE(got->size() == 1);
  CHECK(got->front().challenges == std::vector<std::string>{"Basic realm=\"a\"", "Digest nonce=\"b\""});
  CHECK(got->front().cookies == std::vector<std::string>{"a=1; path=/", "b=2"});
}
