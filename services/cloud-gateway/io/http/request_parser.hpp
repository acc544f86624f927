// The request line and headers of a request, as their bytes come.
#pragma once

#include <memory>
#include <string>

#include "services/cloud-gateway/io/http/request_headers.hpp"

namespace trb::gateway {

/// One request's. Boost.Beast reads the lines; the body is not its matter (body_reader.hpp).
class RequestParser {
 public:
  RequestParser();
  ~RequestParser();
  RequestParser(const RequestParser&) = delete;
  RequestParser& operator=(const RequestParser&) = delete;

  enum class State { more, done, fault };
  /// Takes what it has read from the front of `input`. Not after `done` or `fault`.
  State feed(std::string& input);
  /// After `done`, once.
  RawHead take();
  /// After `fault`: 400, 431 (over kMaxRequestHead), 505.
  [[nodiscard]] HttpFault fault() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace trb::gateway
