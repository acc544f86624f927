// What is read from a request's headers, and which requests are refused before anybody looks at them.
#include "services/cloud-gateway/io/http/request_headers.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

RawHead raw_get(std::vector<HeaderField> more, std::string method = "GET") {
  RawHead out{std::move(method), "/api/v1/me?x=1", 11, {{"Host", "hall.example:8443"}}};
  out.headers.insert(out.headers.end(), more.begin(), more.end());
  return out;
}

ReadHead accepted(RawHead raw) {
  auto read = read_head(std::move(raw));
  REQUIRE(std::holds_alternative<ReadHead>(read));
  return std::get<ReadHead>(std::move(read));
}

HttpFault refused(RawHead raw) {
  const auto read = read_head(std::move(raw));
  REQUIRE(std::holds_alternative<HttpFault>(read));
  const HttpFault fault = std::get<HttpFault>(read);
  CHECK_FALSE(fault.detail.empty());
  CHECK_FALSE(fault.hint.empty());
  return fault;
}

std::vector<HeaderField> websocket(const std::string& key = "dGhlIHNhbXBsZSBub25jZQ==",
                                   const std::string& version = "13") {
  return {{"Connection", "keep-alive, Upgrade"},
          {"Upgrade", "WebSocket"},
          {"Sec-WebSocket-Key", key},
          {"Sec-WebSocket-Version", version}};
}

}  // namespace

TEST_CASE("every header that the API needs is found, whatever its case") {
  const ReadHead head = accepted(raw_get({{"ORIGIN", "https://hall.example:8443"},
                                          {"x-csrf-token", "c"},
                                          {"Content-Type", "application/json"},
                                          {"If-Match", "\"1\""},
                                          {"If-None-Match", "*"},
                                          {"Idempotency-Key", "k"},
                                          {"Content-Length", "12"},
                                          {"Authorization", "bearer  trb_1"}},
                                         "POST"));
  const HttpRequest& request = head.request;
  CHECK(request.method == "POST");
  CHECK(request.target == "/api/v1/me?x=1");
  CHECK(request.host == "hall.example:8443");
  CHECK(request.origin == "https://hall.example:8443");
  CHECK(request.csrf == "c");
  CHECK(request.content_type == "application/json");
  CHECK(request.if_match == "\"1\"");
  CHECK(request.if_none_match == "*");
  CHECK(request.idempotency_key == "k");
  CHECK(request.bearer == "trb_1");
  CHECK_FALSE(request.session);
  CHECK(head.body_size == 12);
  CHECK(head.keep_alive);
  CHECK_FALSE(head.is_chunked);
}

TEST_CASE("what is not sent is missing, and the request's head points at the same texts") {
  const ReadHead head = accepted(raw_get({}));
  CHECK_FALSE(head.request.origin);
  CHECK_FALSE(head.request.bearer);
  CHECK_FALSE(head.websocket_key);
  const RequestHead view = head.request.head();
  CHECK(view.method == "GET");
  CHECK(view.host == "hall.example:8443");
  CHECK_FALSE(view.csrf);
}

TEST_CASE("the session is in our cookie alone, among others") {
  const auto session = [](const std::string& cookies) {
    return accepted(raw_get({{"Cookie", cookies}})).request.session;
  };
  CHECK(session("__Host-trb=abc") == "abc");
  CHECK(session("a=1; __Host-trb=abc ;b=2") == "abc");
  CHECK(session("__Host-trb=") == "");
  CHECK(session("__host-trb=abc; x__Host-trb=abc; __Host-trb; =; ;") == std::nullopt);
  CHECK(refused(raw_get({{"Cookie", "__Host-trb=a; __Host-trb=b"}})).status == 400);
}

TEST_CASE("another scheme than Bearer is nobody") {
  for (const char* text : {"Basic YTpi", "Bearer", "", "Bearertrb_1", "trb_1"}) {
    CAPTURE(text);
    CHECK_FALSE(accepted(raw_get({{"Authorization", text}})).request.bearer);
  }
}

TEST_CASE("given a header that decides stands twice, then the request is refused") {
  for (const char* name : {"host", "Cookie", "authorization", "origin", "content-length", "x-csrf-token",
                           "Idempotency-Key", "if-match", "if-none-match", "content-type", "upgrade",
                           "sec-websocket-key", "sec-websocket-version", "transfer-encoding", "Expect"}) {
    CAPTURE(name);
    const HttpFault fault = refused(raw_get({{name, "1"}, {name, "1"}}));
    CHECK(fault.status == 400);
    CHECK(fault.code == "bad_request");
  }
  CHECK(accepted(raw_get({{"Accept", "a"}, {"Accept", "b"}})).keep_alive);
}

TEST_CASE("given two ways to read the body's length, then the request is refused (RFC 9112, 6.1)") {
  CHECK(refused(raw_get({{"Content-Length", "3"}, {"Transfer-Encoding", "chunked"}})).status == 400);
  for (const char* length : {"", "-1", "+1", "-0", "1, 1", "0x1", "1 ", "18446744073709551616"}) {
    CAPTURE(length);
    CHECK(refused(raw_get({{"Content-Length", length}})).status == 400);
  }
  for (const char* coding : {"gzip, chunked", "xchunked", "identity", "chunked, chunked", ""}) {
    CAPTURE(coding);
    CHECK(refused(raw_get({{"Transfer-Encoding", coding}})).status == 501);
  }
  RawHead old = raw_get({{"Transfer-Encoding", "chunked"}});
  old.version = 10;
  CHECK(refused(old).status == 400);
  CHECK(accepted(raw_get({{"Transfer-Encoding", "Chunked"}})).is_chunked);
}

TEST_CASE("HTTP/1.1 needs a Host, HTTP/1.0 does not") {
  RawHead raw{"GET", "/", 11, {}};
  CHECK(refused(raw).status == 400);
  raw.version = 10;
  CHECK(accepted(raw).request.host.empty());
}

TEST_CASE("a connection persists as its version and Connection say (RFC 9112, 9.3)") {
  const auto persists = [](int version, std::vector<HeaderField> headers) {
    RawHead raw = raw_get(std::move(headers));
    raw.version = version;
    return accepted(std::move(raw)).keep_alive;
  };
  CHECK(persists(11, {}));
  CHECK_FALSE(persists(11, {{"Connection", "Close"}}));
  CHECK_FALSE(persists(11, {{"Connection", "keep-alive"}, {"Connection", "x, close"}}));
  CHECK_FALSE(persists(10, {}));
  CHECK(persists(10, {{"Connection", "Keep-Alive"}}));
}

TEST_CASE("HEAD comes as GET, without its body") {
  const ReadHead head = accepted(raw_get({}, "HEAD"));
  CHECK(head.is_head);
  CHECK(head.request.method == "GET");
  CHECK_FALSE(accepted(raw_get({})).is_head);
}

TEST_CASE("Expect: 100-continue is a question if there is a body; anything else is refused") {
  CHECK(accepted(raw_get({{"Expect", "100-Continue"}, {"Content-Length", "1"}}, "POST")).expects_continue);
  CHECK(accepted(raw_get({{"Expect", "100-continue"}, {"Transfer-Encoding", "chunked"}}, "POST")).expects_continue);
  CHECK_FALSE(accepted(raw_get({{"Expect", "100-continue"}})).expects_continue);
  CHECK(refused(raw_get({{"Expect", "cake"}})).status == 417);
}

TEST_CASE("an upgrade needs GET, HTTP/1.1, version 13 and a key (RFC 6455, 4.2.1)") {
  CHECK(accepted(raw_get(websocket())).websocket_key == "dGhlIHNhbXBsZSBub25jZQ==");
  CHECK(refused(raw_get(websocket("dGhlIHNhbXBsZSBub25jZQ==", "8"))).status == 426);
  for (const char* key :
       {"", "dGhl", "dGhlIHNhbXBsZSBub25jZQ=", "dGhlIHNhbXBsZSBub25j*Q==", "dGhlIHNhbXBsZSBub25jZQ==="})
    CHECK(refused(raw_get(websocket(key))).status == 400);
  auto with_body = websocket();
  with_body.push_back({"Content-Length", "1"});
  CHECK(refused(raw_get(with_body)).status == 400);
}

TEST_CASE("what is no upgrade to a WebSocket is a plain request") {
  CHECK_FALSE(accepted(raw_get(websocket(), "POST")).websocket_key);
  CHECK_FALSE(accepted(raw_get(websocket(), "HEAD")).websocket_key);
  CHECK_FALSE(accepted(raw_get({{"Upgrade", "websocket"}})).websocket_key);
  CHECK_FALSE(accepted(raw_get({{"Connection", "upgrade"}, {"Upgrade", "h2c"}})).websocket_key);
  RawHead old = raw_get(websocket());
  old.version = 10;
  CHECK_FALSE(accepted(old).websocket_key);
}

TEST_CASE("gzip is accepted if Accept-Encoding has it, and not with the weight 0") {
  for (const char* yes : {"gzip", "br, GZIP", "deflate,gzip;q=0.5, *;q=0", "gzip; q=1.000"}) {
    CAPTURE(yes);
    CHECK(accepted(raw_get({{"Accept-Encoding", yes}})).request.accepts_gzip);
  }
  for (const char* no : {"", "br", "gzip;q=0", "gzip ; Q=0.000", "x-gzip", "identity", "*"}) {
    CAPTURE(no);
    CHECK_FALSE(accepted(raw_get({{"Accept-Encoding", no}})).request.accepts_gzip);
  }
  CHECK_FALSE(accepted(raw_get({})).request.accepts_gzip);
  CHECK(accepted(raw_get({{"Accept-Encoding", "br"}, {"accept-encoding", "gzip"}})).request.accepts_gzip);
}
