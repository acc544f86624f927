#include "services/cloud-gateway/io/http/request_headers.hpp"

#include <algorithm>
#include <array>

#include "common/base/number_text.hpp"

namespace trb::gateway {
namespace {

using Fault = std::optional<HttpFault>;

/// Those that may stand once.
constexpr std::array kOnce{
    "host",
    "cookie",
    "authorization",
    "origin",
    "content-length",
    "transfer-encoding",
    "content-type",
    "if-match",
    "if-none-match",
    "x-csrf-token",
    "idempotency-key",
    "expect",
    "upgrade",
    "sec-websocket-key",
    "sec-websocket-version",
};

char lower(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

bool is_word(std::string_view text, std::string_view lower_case) {
  return std::ranges::equal(text, lower_case, {}, lower);
}

std::string_view trimmed(std::string_view text) {
  constexpr std::string_view kSpace = " \t";
  const std::size_t begin = text.find_first_not_of(kSpace);
  if (begin == std::string_view::npos) return {};
  return text.substr(begin, text.find_last_not_of(kSpace) - begin + 1);
}

/// The parts between the separators.
std::vector<std::string_view> parts(std::string_view text, char separator) {
  std::vector<std::string_view> out;
  for (;;) {
    const std::size_t end = text.find(separator);
    out.push_back(trimmed(text.substr(0, end)));
    if (end == std::string_view::npos) return out;
    text.remove_prefix(end + 1);
  }
}

/// Is the word in the list ("keep-alive, Upgrade")?
bool lists(const std::optional<std::string>& header, std::string_view word) {
  if (!header) return false;
  return std::ranges::any_of(parts(*header, ','), [&](std::string_view part) { return is_word(part, word); });
}

std::size_t count_of(const RawHead& raw, std::string_view name) {
  return static_cast<std::size_t>(
      std::ranges::count_if(raw.headers, [&](const HeaderField& field) { return is_word(field.name, name); }));
}

/// Moves the header's value out of the list.
std::optional<std::string> take(RawHead& raw, std::string_view name) {
  const auto at =
      std::ranges::find_if(raw.headers, [&](const HeaderField& field) { return is_word(field.name, name); });
  if (at == raw.headers.end()) return std::nullopt;
  return std::move(at->value);
}

/// `Connection` may stand several times: then it is one list (RFC 9110, 5.3).
std::optional<std::string> take_list(RawHead& raw, std::string_view name) {
  std::optional<std::string> out;
  for (const HeaderField& field : raw.headers)
    if (is_word(field.name, name)) out = (out ? *out + "," : std::string()) + field.value;
  return out;
}

Fault check_repeated(const RawHead& raw) {
  for (const char* name : kOnce)
    if (count_of(raw, name) > 1)
      return bad_request("the header " + std::string(name) + " stands more than once", "send it once");
  return std::nullopt;
}

/// RFC 6265, 4.2.1: "a=1; b=2". Other cookies of this host are not ours.
Fault read_cookies(RawHead& raw, HttpRequest& out) {
  const std::string cookies = take(raw, "cookie").value_or("");
  for (const std::string_view cookie : parts(cookies, ';')) {
    const std::size_t equals = cookie.find('=');
    if (equals == std::string_view::npos || cookie.substr(0, equals) != kSessionCookie) continue;
    if (out.session) return bad_request("two cookies " + std::string(kSessionCookie), "remove this site's cookies");
    out.session = cookie.substr(equals + 1);
  }
  return std::nullopt;
}

/// RFC 6750, 2.1; the scheme's case does not matter (RFC 9110, 11.1). Another scheme is nobody.
void read_authorization(RawHead& raw, HttpRequest& out) {
  const auto text = take(raw, "authorization");
  const std::size_t space = text.value_or("").find(' ');
  if (!text || space == std::string::npos || !is_word(text->substr(0, space), "bearer")) return;
  out.bearer = trimmed(std::string_view(*text).substr(space));
}

/// RFC 9110, 12.5.3: "gzip, br;q=0.5". Refused with q=0; other weights do not matter, for there are two forms alone.
bool accepts_gzip(const std::optional<std::string>& codings) {
  if (!codings) return false;
  return std::ranges::any_of(parts(*codings, ','), [](std::string_view coding) {
    const auto words = parts(coding, ';');
    const bool is_refused = words.size() > 1 && (is_word(words[1].substr(0, 2), "q=")) &&
                            words[1].find_first_not_of("0.", 2) == std::string_view::npos;
    return is_word(words[0], "gzip") && !is_refused;
  });
}

Fault read_request(RawHead& raw, ReadHead& out) {
  HttpRequest& request = out.request;
  out.is_head = raw.method == "HEAD";
  request.method = out.is_head ? "GET" : std::move(raw.method);
  request.target = std::move(raw.target);
  request.origin = take(raw, "origin");
  request.csrf = take(raw, "x-csrf-token");
  request.content_type = take(raw, "content-type");
  request.if_match = take(raw, "if-match");
  request.if_none_match = take(raw, "if-none-match");
  request.idempotency_key = take(raw, "idempotency-key");
  request.accepts_gzip = accepts_gzip(take_list(raw, "accept-encoding"));
  read_authorization(raw, request);
  return read_cookies(raw, request);
}

Fault read_host(RawHead& raw, ReadHead& out) {
  auto host = take(raw, "host");
  if (!host && raw.version >= 11) return bad_request("no Host header", "send Host: the name and port of the gateway");
  out.request.host = std::move(host).value_or("");
  return std::nullopt;
}

Fault read_length(RawHead& raw, ReadHead& out) {
  const auto length = take(raw, "content-length");
  if (!length) return std::nullopt;
  // std::from_chars would take "-0".
  const bool digits = std::ranges::all_of(*length, [](char c) { return c >= '0' && c <= '9'; });
  const auto size = parse_number<std::uint64_t>(*length);
  if (!digits || !size) return bad_request("Content-Length is no number", "send the size of the body in bytes");
  out.body_size = *size;
  return std::nullopt;
}

Fault read_framing(RawHead& raw, ReadHead& out) {
  const auto coding = take(raw, "transfer-encoding");
  if (!coding) return read_length(raw, out);
  if (count_of(raw, "content-length") > 0 || raw.version < 11)
    return bad_request("Transfer-Encoding with Content-Length or in HTTP/1.0", "send one of the two");
  if (!is_word(*coding, "chunked"))
    return HttpFault{501, "unknown_transfer_coding", "a Transfer-Encoding other than chunked",
                     "send the body as it is, with Content-Length"};
  out.is_chunked = true;
  return std::nullopt;
}

Fault read_expect(RawHead& raw, ReadHead& out) {
  const auto expect = take(raw, "expect");
  if (!expect || raw.version < 11) return std::nullopt;  // RFC 9110, 10.1.1: of HTTP/1.0 it is ignored
  if (!is_word(*expect, "100-continue"))
    return HttpFault{417, "unknown_expectation", "Expect is not 100-continue", "leave Expect out"};
  out.expects_continue = out.is_chunked || out.body_size > 0;
  return std::nullopt;
}

/// 16 bytes in Base64 (RFC 6455, 4.1): 22 digits and "==".
bool is_websocket_key(std::string_view key) {
  const auto is_digit = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '+' || c == '/';
  };
  return key.size() == 24 && key.ends_with("==") && std::ranges::all_of(key.substr(0, 22), is_digit);
}

Fault read_websocket(RawHead& raw, ReadHead& out) {
  const auto version = take(raw, "sec-websocket-version");
  auto key = take(raw, "sec-websocket-key");
  if (version != "13")
    return HttpFault{426, "unknown_websocket_version", "Sec-WebSocket-Version is not 13", "use RFC 6455"};
  if (!key || !is_websocket_key(*key))
    return bad_request("Sec-WebSocket-Key is not 16 bytes in Base64", "make a new one for each WebSocket");
  if (out.is_chunked || out.body_size > 0) return bad_request("an upgrade with a body", "send none");
  out.websocket_key = std::move(key);
  return std::nullopt;
}

/// RFC 9112, 9.3, and RFC 9110, 7.8: an Upgrade to anything else is ignored.
Fault read_connection(RawHead& raw, ReadHead& out) {
  const auto options = take_list(raw, "connection");
  const bool persists = raw.version >= 11 || lists(options, "keep-alive");
  out.keep_alive = persists && !lists(options, "close");
  const bool upgrades = raw.version >= 11 && out.request.method == "GET" && !out.is_head && lists(options, "upgrade");
  return upgrades && lists(take(raw, "upgrade"), "websocket") ? read_websocket(raw, out) : std::nullopt;
}

}  // namespace

std::variant<ReadHead, HttpFault> read_head(RawHead raw) {
  if (auto fault = check_repeated(raw)) return *fault;
  ReadHead out;
  for (const auto step : {read_host, read_framing, read_expect, read_request, read_connection})
    if (auto fault = step(raw, out)) return *fault;
  return out;
}

}  // namespace trb::gateway
