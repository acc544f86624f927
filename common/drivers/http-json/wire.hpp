// Requests and answers of HTTP/1.1 as bytes.
#pragma once

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb::drivers {

struct HttpRequest {
  std::string method;
  std::string target;
  std::string body;  ///< empty: none
};

using HttpFields = std::vector<std::pair<std::string, std::string>>;

/// `fields` of the header; they may be secret, and are never logged.
Bytes encode(const HttpRequest& request, const HttpFields& fields);

struct HttpAnswer {
  unsigned status = 0;
  std::string body;
  bool closes = false;                    ///< the robot closes the connection after it
  std::vector<std::string> challenges{};  ///< WWW-Authenticate
  std::vector<std::string> cookies{};     ///< Set-Cookie

  [[nodiscard]] bool good() const { return status >= 200 && status < 300; }
};

/// Answers from a stream, however it is cut; by Boost.Beast, whose parser needs no socket.
class HttpReader {
 public:
  static constexpr std::size_t kMaxBody = 1U << 20U;
  static constexpr std::size_t kMaxHeader = 16384;

  HttpReader();
  ~HttpReader();
  HttpReader(const HttpReader&) = delete;
  HttpReader& operator=(const HttpReader&) = delete;

  /// Errors: malformed, too_large: the connection can no longer be used.
  Result<std::vector<HttpAnswer>> add(BytesView bytes);
  /// The connection has ended: an answer without a length ends with it.
  std::vector<HttpAnswer> end();
  void clear();

 private:
  struct Parser;
  void take(std::vector<HttpAnswer>& out);

  std::unique_ptr<Parser> parser_;
  Bytes rest_;  ///< not parsed yet: an incomplete header
};

}  // namespace trb::drivers
