#include "services/cloud-gateway/io/http/reply_head.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>

namespace trb::gateway {
namespace {

using HeaderPair = std::pair<std::string_view, std::string_view>;

constexpr std::array kSecurityHeaders{
    HeaderPair{"Strict-Transport-Security", "max-age=31536000"},
    HeaderPair{"Content-Security-Policy",
               "default-src 'self'; frame-ancestors 'none'; base-uri 'none'; form-action 'self'; object-src 'none'"},
    HeaderPair{"X-Content-Type-Options", "nosniff"},
    HeaderPair{"Referrer-Policy", "no-referrer"},
    HeaderPair{"Cross-Origin-Opener-Policy", "same-origin"},
    HeaderPair{"Cross-Origin-Resource-Policy", "same-origin"},
    HeaderPair{"Permissions-Policy", "camera=(), geolocation=(), microphone=(), payment=(), usb=()"},
};

/// Besides the above: what the server writes, or leaves out.
constexpr std::array kOwn{"connection", "content-length", "content-type",      "date",   "keep-alive",
                          "server",     "trailer",        "transfer-encoding", "upgrade"};

struct StatusRow {
  int status;
  std::string_view reason;
};
constexpr std::array kReasons{
    StatusRow{200, "OK"},
    StatusRow{201, "Created"},
    StatusRow{202, "Accepted"},
    StatusRow{204, "No Content"},
    StatusRow{304, "Not Modified"},
    StatusRow{400, "Bad Request"},
    StatusRow{401, "Unauthorized"},
    StatusRow{403, "Forbidden"},
    StatusRow{404, "Not Found"},
    StatusRow{405, "Method Not Allowed"},
    StatusRow{408, "Request Timeout"},
    StatusRow{409, "Conflict"},
    StatusRow{412, "Precondition Failed"},
    StatusRow{413, "Content Too Large"},
    StatusRow{415, "Unsupported Media Type"},
    StatusRow{417, "Expectation Failed"},
    StatusRow{422, "Unprocessable Content"},
    StatusRow{426, "Upgrade Required"},
    StatusRow{428, "Precondition Required"},
    StatusRow{429, "Too Many Requests"},
    StatusRow{431, "Request Header Fields Too Large"},
    StatusRow{500, "Internal Server Error"},
    StatusRow{501, "Not Implemented"},
    StatusRow{503, "Service Unavailable"},
    StatusRow{505, "HTTP Version Not Supported"},
};

char lower_case(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool is_same_word(std::string_view a, std::string_view b) {
  return std::ranges::equal(a, b, {}, lower_case, lower_case);
}

/// RFC 9110, 5.6.2.
bool is_token(std::string_view text) {
  const auto may_stand = [](char c) {
    const bool letter = (lower_case(c) >= 'a' && lower_case(c) <= 'z') || (c >= '0' && c <= '9');
    return letter || (c != '\0' && std::string_view("!#$%&'*+-.^_`|~").find(c) != std::string_view::npos);
  };
  return !text.empty() && std::ranges::all_of(text, may_stand);
}

/// Printable ASCII: all that a new header needs (RFC 9110, 5.5).
bool is_value(std::string_view text) {
  return std::ranges::all_of(text, [](char c) { return c >= ' ' && c <= '~'; });
}

bool is_written_here(std::string_view name) {
  const auto is_it = [&](std::string_view own) { return is_same_word(own, name); };
  return std::ranges::any_of(kOwn, is_it) ||
         std::ranges::any_of(kSecurityHeaders, [&](const HeaderPair& header) { return is_it(header.first); });
}

Status check_reply(const HttpReply& reply) {
  if (reply.status < 200 || reply.status > 599) return fail(Errc::bad_value, "reply: its status is none");
  if (!is_value(reply.content_type)) return fail(Errc::bad_value, "reply: Content-Type is no header's value");
  for (const auto& [name, value] : reply.headers) {
    if (!is_token(name) || is_written_here(name))
      return fail(Errc::bad_value, "reply: a header that is none, or that the server writes itself");
    if (!is_value(value)) return fail(Errc::bad_value, "reply: " + name + " is no header's value");
  }
  return Done{};
}

std::string_view reason_of(int status) {
  const auto* const row = std::ranges::find(kReasons, status, &StatusRow::status);
  return row == kReasons.end() ? std::string_view() : row->reason;
}

/// "Sun, 06 Nov 1994 08:49:37 GMT" (RFC 9110, 5.6.7), whatever the locale is.
std::string http_date(UtcTime now) {
  constexpr std::array kDays{"Sun", "Mon", "Tue", "Wed", "Thu", "Fri", "Sat"};
  constexpr std::array kMonths{"Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec"};
  const std::time_t seconds_since_1970 = now.ns / 1'000'000'000;
  std::tm parts{};
  ::gmtime_r(&seconds_since_1970, &parts);
  char rest[32];
  std::strftime(rest, sizeof rest, " %Y %H:%M:%S GMT", &parts);
  const std::string day = std::to_string(parts.tm_mday);
  return std::string(kDays[parts.tm_wday]) + ", " + (day.size() < 2 ? "0" : "") + day + " " + kMonths[parts.tm_mon] +
         rest;
}

/// The same within a second.
const std::string& date_of(UtcTime now) {
  thread_local std::int64_t second = -1;
  thread_local std::string text;
  if (const std::int64_t next = now.ns / 1'000'000'000; text.empty() || next != second) {
    second = next;
    text = http_date(now);
  }
  return text;
}

void put(std::string& out, std::string_view name, std::string_view value) {
  out.append(name).append(": ").append(value).append("\r\n");
}

const std::string& security_lines() {
  static const std::string kLines = [] {
    std::string out;
    for (const auto& [name, value] : kSecurityHeaders) put(out, name, value);
    return out;
  }();
  return kLines;
}

bool sets(const HttpReply& reply, std::string_view name) {
  return std::ranges::any_of(reply.headers, [&](const auto& header) { return is_same_word(header.first, name); });
}

void put_body_headers(std::string& out, const HttpReply& reply) {
  if (!may_have_body(reply.status)) return;
  if (reply.body && !reply.content_type.empty()) put(out, "Content-Type", reply.content_type);
  put(out, "Content-Length", std::to_string(reply.body ? reply.body->size() : 0));
}

}  // namespace

std::span<const std::pair<std::string_view, std::string_view>> security_headers() {
  return kSecurityHeaders;
}

bool may_have_body(int status) {
  return status >= 200 && status != 204 && status != 304;
}

Result<std::string> reply_head(const HttpReply& reply, bool keep_alive, UtcTime now) {
  if (const Status fits = check_reply(reply); !fits) return fits.error();
  std::string out;
  out.reserve(2048);  // a short body follows in the same piece
  out.append("HTTP/1.1 ").append(std::to_string(reply.status)).append(" ");
  out.append(reason_of(reply.status)).append("\r\nDate: ").append(date_of(now));
  out.append(keep_alive ? "\r\nConnection: keep-alive\r\n" : "\r\nConnection: close\r\n").append(security_lines());
  if (reply.content_type.starts_with("application/") && !sets(reply, "Cache-Control"))
    put(out, "Cache-Control", "no-store");
  for (const auto& [name, value] : reply.headers) put(out, name, value);
  put_body_headers(out, reply);
  out.append("\r\n");
  return out;
}

}  // namespace trb::gateway
