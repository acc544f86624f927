// The notation of commands.json for a robot with HTTP and JSON.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/base/result.hpp"
#include "common/drivers/text/vendor_template.hpp"
#include "proto/value.hpp"

namespace trb::drivers {

/// Texts from earlier answers, by name: a path may need one.
using Remembered = std::map<std::string, std::string, std::less<>>;

/// How the bodies of requests are written.
enum class HttpBody : std::uint8_t { json, form };

/// "/api/v2.0.0/mission_queue/<mission>", "/missions/{0}".
class HttpPath {
 public:
  HttpPath() = default;
  /// Errors: bad_value (not a path, or a character that must be written as %XX).
  static Result<HttpPath> read(std::string_view text);

  [[nodiscard]] const std::string& text() const { return text_; }
  [[nodiscard]] bool needs_data() const { return text_.find('{') != std::string::npos; }
  /// With {data} or {0}, {1} ... filled in, everything except letters and digits as %XX. Errors: bad_value,
  /// not_escapable: a text that could lead to another path.
  [[nodiscard]] Result<HttpPath> with(BytesView data) const;
  /// The names between < and >.
  [[nodiscard]] std::vector<std::string> names() const;
  /// With each name filled in, everything except letters and digits as %XX. Errors: missing (no answer has provided it
  /// yet).
  [[nodiscard]] Result<std::string> fill(const Remembered& known) const;

 private:
  std::string text_;
};

/// One line of a command: "[always] METHOD PATH [BODY] [-> NAME POINTER]", for example
///   PUT /api/v2.0.0/status {"state_id": 4}
///   POST /api/v2.0.0/mission_queue {"mission_id": {0}} -> mission /id
///   always POST /rw/mastership/rapid?action=release
struct HttpCall {
  bool always = false;  ///< sent also if a line before it was refused, or the command was dropped
  std::string method;   ///< GET, POST, PUT, PATCH or DELETE
  HttpPath path;
  std::optional<VendorTemplate> body;  ///< with {data} or {0}, {1} …
  std::string remembers;               ///< the name under which that part of the answer is kept; empty: nothing is
  std::string pointer;                 ///< where (RFC 6901)
};

/// One a line. Errors: bad_value.
Result<std::vector<HttpCall>> read_http_calls(std::string_view text, HttpBody body = HttpBody::json);

/// A value as it stands in a body of that kind: as JSON, or as %XX. Errors: bad_value.
Literal http_literal(HttpBody body);

/// "GET PATH POINTER [TEXT=NUMBER ...] [POINTER ...]", for example `GET /status /position/x /position/y`,
/// `GET /queue/<mission> /state Pending=0 Executing=1 Done=2 Aborted=3`, `GET /joints /rax_1 number /rax_2 number`.
struct HttpQuestion {
  struct Part {
    std::string pointer;
    std::map<std::string, double, std::less<>> numbers{};  ///< of texts
    bool is_number = false;                                ///< a text is read as a number
  };
  HttpPath path;
  std::vector<Part> parts;
};

/// Errors: bad_value.
Result<HttpQuestion> read_http_question(std::string_view text);

/// The target of a JSON pointer (RFC 6901), or nullptr.
const Value* find_by_pointer(const Value& json, std::string_view pointer);

}  // namespace trb::drivers
