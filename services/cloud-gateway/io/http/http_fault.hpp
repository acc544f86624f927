// What is wrong with a request as HTTP: what HttpHandler::refusal() is told.
#pragma once

#include <string>

namespace trb::gateway {

struct HttpFault {
  int status = 400;
  std::string code;  ///< stable: "bad_request"
  std::string detail;
  std::string hint;
};

/// 400, for bytes that are not HTTP as the server takes it.
inline HttpFault bad_request(std::string detail, std::string hint) {
  return {400, "bad_request", std::move(detail), std::move(hint)};
}

}  // namespace trb::gateway
