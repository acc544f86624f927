#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "services/virtual-robots/support/http_server.hpp"

namespace trb::virtual_robots::rws {

struct AccessSettings {
  std::string user = "Default User";
  std::string password = "robotics";
  unsigned nonce_uses = 100;  ///< requests for which one nonce is good
  std::size_t most_sessions = 70;
};

/**
 * Who may ask: Digest with MD5 (RFC 2617), and sessions. A request without the cookie of a session begins one; when all
 * are taken, such a request is refused with 503.
 */
class Access {
 public:
  explicit Access(AccessSettings settings) : settings_(std::move(settings)) {}

  struct Entry {
    std::uint64_t session = 0;           ///< 0: refused
    std::optional<HttpReply> refusal{};  ///< why
    std::string cookie{};                ///< of a session that has begun
  };
  Entry enter(const HttpRequest& request);
  /** The session ends, and its cookie with it. */
  void leave(std::uint64_t session);
  std::size_t sessions() const { return sessions_.size(); }

 private:
  struct Nonce {
    unsigned long count = 0;  ///< the highest that a client has used
  };
  HttpReply challenge(bool stale);
  /** Nothing: signed in. */
  std::optional<HttpReply> check(const HttpRequest& request);

  AccessSettings settings_;
  std::map<std::string, Nonce> nonces_;
  std::map<std::string, std::uint64_t> sessions_;  ///< by cookie
  std::uint64_t last_nonce_ = 0;
  std::uint64_t last_session_ = 0;
};

/** The value of `name` in an Authorization by Digest. */
std::string digest_parameter(const std::string& authorization, const std::string& name);
/** MD5 in hexadecimal. */
std::string md5_of(const std::string& text);

}  // namespace trb::virtual_robots::rws
