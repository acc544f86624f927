// The head of a reply: what each has, and what none may have.
#include "services/cloud-gateway/io/http/reply_head.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr UtcTime kSunday{784'111'777'000'000'000};  // the example of RFC 9110, 5.6.7

std::string head_text(const HttpReply& reply) {
  const auto head = reply_head(reply, true, kSunday);
  REQUIRE(head);
  return *head;
}

bool has_line(const std::string& head, const std::string& line) {
  return head.find("\r\n" + line + "\r\n") != std::string::npos;
}

std::shared_ptr<const Bytes> shared(Bytes bytes) {
  return std::make_shared<const Bytes>(std::move(bytes));
}

}  // namespace

TEST_CASE("a reply has its status, date, type, size and headers, and ends with an empty line") {
  const std::string head = head_text({200, "text/html", {{"ETag", "\"1\""}}, shared("abc")});
  CHECK(head.starts_with("HTTP/1.1 200 OK\r\n"));
  CHECK(head.ends_with("\r\n\r\n"));
  CHECK(has_line(head, "Date: Sun, 06 Nov 1994 08:49:37 GMT"));
  CHECK(has_line(head, "Content-Type: text/html"));
  CHECK(has_line(head, "Content-Length: 3"));
  CHECK(has_line(head, "ETag: \"1\""));
  CHECK(has_line(head, "Connection: keep-alive"));
  CHECK(has_line(*reply_head({}, false, kSunday), "Connection: close"));
}

TEST_CASE("every reply, also an error, tells the browser what is not allowed; and not who the server is") {
  for (const int status : {200, 204, 304, 404, 500, 599}) {
    const std::string head = head_text({status, "text/plain", {}, nullptr});
    CHECK(has_line(head, "Strict-Transport-Security: max-age=31536000"));
    CHECK(has_line(head,
                   "Content-Security-Policy: default-src 'self'; frame-ancestors 'none'; base-uri 'none'; "
                   "form-action 'self'; object-src 'none'"));
    CHECK(has_line(head, "X-Content-Type-Options: nosniff"));
    CHECK(has_line(head, "Referrer-Policy: no-referrer"));
    CHECK(has_line(head, "Cross-Origin-Opener-Policy: same-origin"));
    CHECK(has_line(head, "Cross-Origin-Resource-Policy: same-origin"));
    CHECK(head.find("\r\nPermissions-Policy: ") != std::string::npos);
    CHECK(head.find("\r\nServer:") == std::string::npos);
    CHECK(head.find("unsafe") == std::string::npos);
  }
}

TEST_CASE("data is not cached, unless the reply says so; pages are as they say") {
  CHECK(has_line(head_text({}), "Cache-Control: no-store"));
  CHECK(has_line(head_text({200, "application/problem+json", {}, shared("{}")}), "Cache-Control: no-store"));
  const std::string own = head_text({200, "application/json", {{"cache-control", "no-cache"}}, shared("{}")});
  CHECK(has_line(own, "cache-control: no-cache"));
  CHECK(own.find("no-store") == std::string::npos);
  CHECK(head_text({200, "text/html", {}, shared("x")}).find("Cache-Control") == std::string::npos);
}

TEST_CASE("204 and 304 have no body and no size; 200 without a body has size 0") {
  for (const int status : {204, 304}) {
    CHECK_FALSE(may_have_body(status));
    const std::string head = head_text({status, "application/json", {}, shared("x")});
    CHECK(head.find("Content-Length") == std::string::npos);
    CHECK(head.find("\r\nContent-Type") == std::string::npos);
  }
  CHECK(may_have_body(200));
  CHECK(has_line(head_text({}), "Content-Length: 0"));
}

TEST_CASE("given a reply's header with a line end or another control character, then there is no reply") {
  for (const std::string& bad :
       {std::string("a\r\nSet-Cookie: x=1"), std::string("a\nb"), std::string("a\rb"), std::string("a\0b", 3),
        std::string("\x7f"), std::string("\xc3\xa9"), std::string("\t")}) {
    CAPTURE(bad);
    CHECK_FALSE(reply_head({200, "text/plain", {{"X-A", bad}}, nullptr}, true, kSunday));
    CHECK_FALSE(reply_head({200, "text/plain", {{"X-A" + bad, "a"}}, nullptr}, true, kSunday));
    CHECK_FALSE(reply_head({200, bad, {}, nullptr}, true, kSunday));
  }
  for (const char* name : {"", "a b", "a:", "X-A\r\n"}) {
    CHECK_FALSE(reply_head({200, "text/plain", {{name, "a"}}, nullptr}, true, kSunday));
  }
}

TEST_CASE("a reply cannot set what the server writes itself") {
  for (const char* name : {"Content-Length", "transfer-encoding", "CONNECTION", "Date", "Server", "Content-Type",
                           "content-security-policy", "X-Content-Type-Options"}) {
    CAPTURE(name);
    CHECK_FALSE(reply_head({200, "text/plain", {{name, "1"}}, nullptr}, true, kSunday));
  }
  CHECK_FALSE(reply_head({100, "text/plain", {}, nullptr}, true, kSunday));
  CHECK_FALSE(reply_head({600, "text/plain", {}, nullptr}, true, kSunday));
}
