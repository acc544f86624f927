// From a request's line and headers to what the API and the server need of them. Pure: it knows no parser and no
// socket.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "services/cloud-gateway/io/http/exchange.hpp"
#include "services/cloud-gateway/io/http/http_fault.hpp"

namespace trb::gateway {

struct HeaderField {
  std::string name;   ///< as sent
  std::string value;  ///< without the spaces around it
};

/// The beginning of a request, up to its empty line.
struct RawHead {
  std::string method;
  std::string target;
  int version = 11;  ///< HTTP/1.0: 10
  std::vector<HeaderField> headers;
};

struct ReadHead {
  HttpRequest request;  ///< without source and body
  bool is_head = false;
  bool keep_alive = true;
  bool expects_continue = false;  ///< RFC 9110, 10.1.1
  bool is_chunked = false;
  std::uint64_t body_size = 0;               ///< as announced
  std::optional<std::string> websocket_key;  ///< set: it asks to become a WebSocket (RFC 6455, 4.2.1)
};

/// Refuses (400) a repeated header of those that decide about rights, body or connection: two servers may take
/// different ones of them (RFC 9112, 11.2). Refuses what can be read as two lengths of the body: Transfer-Encoding with
/// Content-Length, or in HTTP/1.0 (6.1), or other than "chunked" (501). No Host in HTTP/1.1: 400 (3.2). Another Expect
/// than 100-continue: 417. A WebSocket of another version than 13: 426.
std::variant<ReadHead, HttpFault> read_head(RawHead raw);

}  // namespace trb::gateway
