// The bytes of a request's head, whole and in pieces.
#include "services/cloud-gateway/io/http/request_parser.hpp"

#include <doctest/doctest.h>

#include "services/cloud-gateway/io/http/http_server.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr std::string_view kRequest = "POST /a?b HTTP/1.1\r\nHost: h\r\nX-A:  1 \r\nX-A: 2\r\n\r\n";

int parsed_status(std::string input) {
  RequestParser parser;
  REQUIRE(parser.feed(input) == RequestParser::State::fault);
  return parser.fault().status;
}

/// Byte by byte: the state that ends it, or `more`.
RequestParser::State fed_slowly(RequestParser& parser, std::string_view bytes, std::string& input) {
  auto state = RequestParser::State::more;
  for (std::size_t i = 0; i < bytes.size() && state == RequestParser::State::more; ++i) {
    input += bytes[i];
    state = parser.feed(input);
  }
  return state;
}

void check_parsed(RequestParser& parser) {
  const RawHead head = parser.take();
  CHECK(head.method == "POST");
  CHECK(head.target == "/a?b");
  CHECK(head.version == 11);
  REQUIRE(head.headers.size() == 3);
  CHECK(head.headers[1].name == "X-A");
  CHECK(head.headers[1].value == "1");
  CHECK(head.headers[2].value == "2");
}

}  // namespace

TEST_CASE("a request is read with all its headers, and what follows is left") {
  RequestParser parser;
  std::string input = std::string(kRequest) + "body";
  REQUIRE(parser.feed(input) == RequestParser::State::done);
  CHECK(input == "body");
  check_parsed(parser);
}

TEST_CASE("the same byte by byte") {
  RequestParser parser;
  std::string input;
  REQUIRE(fed_slowly(parser, kRequest, input) == RequestParser::State::done);
  CHECK(input.empty());
  check_parsed(parser);
}

TEST_CASE("what is no HTTP is refused, with the status that says why") {
  CHECK(parsed_status("\x16\x03\x01 junk\r\n\r\n") == 400);
  CHECK(parsed_status("GET / HTTP/1.1\r\nHost : h\r\n\r\n") == 400);
  CHECK(parsed_status("GET / HTTP/1.1\r\nno colon\r\n\r\n") == 400);
  CHECK(parsed_status("GET / HTTP/2.0\r\n\r\n") == 505);
  CHECK(parsed_status("GET / HTTP/1.1\r\nContent-Length: x\r\n\r\n") == 400);
}

TEST_CASE("given more than 8 kB of headers, at once or in small pieces, then 431") {
  CHECK(parsed_status("GET / HTTP/1.1\r\nX: " + std::string(9000, 'a') + "\r\n\r\n") == 431);
  CHECK(parsed_status("GET /" + std::string(9000, 'a') + " HTTP/1.1\r\n\r\n") == 431);
  RequestParser parser;
  std::string input = "GET / HTTP/1.1\r\n";
  auto state = parser.feed(input);
  std::size_t sent = 0;
  for (; state == RequestParser::State::more && sent < 3 * kMaxRequestHead; sent += 100) {
    input += "X: " + std::string(95, 'a') + "\r\n";
    state = parser.feed(input);
  }
  REQUIRE(state == RequestParser::State::fault);
  CHECK(parser.fault().status == 431);
  CHECK(sent <= kMaxRequestHead + 200);
}
