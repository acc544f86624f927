// The notation of commands.json for a robot with HTTP and JSON.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/config/node_config.hpp"
#include "common/drivers/text/vendor_template.hpp"
#include "proto/value.hpp"

namespace trb::drivers {

/// Texts from earlier answers, by name: a path may need one.
using Remembered = std::map<std::string, std::string, std::less<>>;

/// "/api/v2.0.0/mission_queue/<mission>".
class HttpPath {
 public:
  HttpPath() = default;
  /// Errors: bad_value (not a path, or a character that must be written as %XX).
  static Result<HttpPath> read(std::string_view text);

  [[nodiscard]] const std::string& text() const { return text_; }
  /// The names between < and >.
  [[nodiscard]] std::vector<std::string> names() const;
  /// With each name filled in, everything except letters and digits as %XX. Errors: missing (no answer has provided it
  /// yet).
  [[nodiscard]] Result<std::string> fill(const Remembered& known) const;

 private:
  std::string text_;
};

/// One line of a command: "METHOD PATH [JSON] [-> NAME POINTER]", for example
///   PUT /api/v2.0.0/status {"state_id": 4}
///   POST /api/v2.0.0/mission_queue {"mission_id": {0}} -> mission /id
struct HttpCall {
  std::string method;  ///< GET, POST, PUT, PATCH or DELETE
  HttpPath path;
  std::optional<VendorTemplate> body;  ///< JSON with {data} or {0}, {1} …
  std::string remembers;               ///< the name under which that part of the answer is kept; empty: nothing is
  std::string pointer;                 ///< where (RFC 6901)
};

/// One a line. Errors: bad_value.
Result<std::vector<HttpCall>> read_http_calls(std::string_view text);

/// "GET PATH POINTER [TEXT=NUMBER ...] [POINTER ...]", for example `GET /status /position/x /position/y`,
/// `GET /queue/<mission> /state Pending=0 Executing=1 Done=2 Aborted=3`.
struct HttpQuestion {
  struct Part {
    std::string pointer;
    std::map<std::string, double, std::less<>> numbers;  ///< of texts
  };
  HttpPath path;
  std::vector<Part> parts;
};

/// Errors: bad_value.
Result<HttpQuestion> read_http_question(std::string_view text);

/// The target of a JSON pointer (RFC 6901), or nullptr.
const Value* find_by_pointer(const Value& json, std::string_view pointer);

/// How often values are polled, and how long an answer may take.
struct HttpTiming {
  double poll_s = 0.5;
  double timeout_s = 1;  ///< a stop waits at most this long for the answer in progress
};
HttpTiming http_timing(const VendorCommands& vendor);

}  // namespace trb::drivers
