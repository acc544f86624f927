// A request as a stranger sends it: cut anywhere it is read alike. It is refused with a cure, or becomes a request that
// the check of rights can judge. Nobody is signed in by it.
#include "services/cloud-gateway/core/access/request_check.hpp"
#include "services/cloud-gateway/io/http/request_headers.hpp"
#include "services/cloud-gateway/io/http/request_parser.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::gateway;

struct ReadOnce {
  RequestParser::State state = RequestParser::State::more;
  std::optional<RawHead> head;
};

ReadOnce read_cut(BytesView bytes, std::size_t step) {
  RequestParser parser;
  ReadOnce out;
  std::string waiting;
  for (std::size_t at = 0; at < bytes.size() && out.state == RequestParser::State::more; at += step) {
    waiting += bytes.substr(at, step);
    out.state = parser.feed(waiting);
  }
  if (out.state == RequestParser::State::done) out.head = parser.take();
  if (out.state == RequestParser::State::fault) require(parser.fault().status >= 400, "a fault has a status");
  return out;
}

void judge(const HttpRequest& request) {
  const RandomBytes none = [](std::size_t size) { return Bytes(size, 'x'); };
  const Users users(none);
  Sessions sessions(none);
  const Tokens tokens(none);
  RequestCheck check({"https://localhost:8443"}, users, sessions, tokens);
  const RequestDecision decision = check.check(request.head(), UtcTime{});
  const bool is_open = decision.route != nullptr && decision.route->least == Least::anyone;
  require(decision.verdict != RequestVerdict::allowed || is_open, "a stranger reaches only what is for everybody");
  require(decision.verdict == RequestVerdict::allowed || !decision.hint.empty(), "a refusal has a cure");
}

}  // namespace

std::vector<Bytes> seeds() {
  return {
      "GET /api/v1/robots HTTP/1.1\r\nHost: localhost:8443\r\nCookie: a=1; __Host-trb=00\r\n\r\n",
      "POST /api/v1/session HTTP/1.1\r\nHost: localhost:8443\r\nOrigin: https://localhost:8443\r\nContent-Type: "
      "application/json\r\nContent-Length: 2\r\n\r\n{}",
      "GET /api/v1/live HTTP/1.1\r\nHost: localhost:8443\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
      "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n\r\n",
      "PUT /api/v1/users/%2e%2e HTTP/1.1\r\nHost: x\r\nTransfer-Encoding: chunked\r\nAuthorization: Bearer trb_1\r\n"
      "X-CSRF-Token: 1\r\nIf-Match: \"1\"\r\nIdempotency-Key: k\r\n\r\n0\r\n\r\n",
      "HEAD /metrics HTTP/1.0\r\nConnection: keep-alive\r\n\r\n"};
}

void run(BytesView input) {
  const ReadOnce whole = read_cut(input, std::max<std::size_t>(input.size(), 1));
  const ReadOnce bytewise = read_cut(input, 1);
  // A wrong one may be seen earlier where more of it comes at once.
  require(whole.head.has_value() == bytewise.head.has_value(), "a request is read alike however it is cut");
  if (!whole.head) return;
  require(whole.head->target == bytewise.head->target && whole.head->headers.size() == bytewise.head->headers.size(),
          "its headers, too");
  const auto read = read_head(*whole.head);
  if (const auto* fault = std::get_if<HttpFault>(&read)) return require(fault->status >= 400, "a refusal has a status");
  judge(std::get<ReadHead>(read).request);
}

}  // namespace trb::fuzz
