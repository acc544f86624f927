#include "common/drivers/http-json/keys.hpp"

#include <algorithm>
#include <array>

#include "common/config/robot_tls.hpp"
#include "common/drivers/polled_check.hpp"
#include "common/fleet/did_you_mean.hpp"

namespace trb::drivers {
namespace {

constexpr Range kPoll{0.05, 60, false};
constexpr Range kTimeout{0.1, 30, false};
constexpr std::size_t kMostHeaders = 16;
constexpr std::size_t kMaxHeader = 1024;
constexpr std::array<std::string_view, 6> kOwnHeaders{"Host",           "Authorization", "Cookie",
                                                      "Content-Length", "Connection",    "Transfer-Encoding"};

char small(char c) {
  return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c;
}

bool is_header_name(std::string_view name) {
  const auto fits = [](char c) { return (small(c) >= 'a' && small(c) <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
  return !name.empty() && name.size() <= 64 && std::ranges::all_of(name, fits);
}

/// Checks one header. Nothing: it is reported.
std::optional<std::string> read_header(ObjectReader& headers, const std::string& name) {
  const std::size_t before = headers.faults().count();
  if (!is_header_name(name)) {
    headers.faults().add(headers.path(name), in_quotes(name) + " is no name of a header", "use letters, digits and -");
  }
  if (std::ranges::any_of(kOwnHeaders, [&](std::string_view own) { return same_header(own, name); })) {
    headers.faults().add(headers.path(name), "is a header that the node itself writes",
                         "remove it; the sign-in is in keys/robot.auth, and \"cookies\": true keeps cookies");
  }
  auto text = headers.text(name, Need::required, kMaxHeader);
  const auto breaks = [](char c) { return c < ' ' || c == '\x7f'; };
  if (text && std::ranges::any_of(*text, breaks)) {
    headers.faults().add(headers.path(name), "has a line end or another character that no header may have",
                         "write one line of printable characters");
  }
  return headers.faults().count() == before ? text : std::nullopt;
}

void read_headers(ObjectReader& vendor, VendorCommands& into) {
  const auto* members = vendor.object("headers", Need::optional, kMostHeaders);
  if (members == nullptr) return;
  const Value json{*members};
  ObjectReader headers(json, vendor.path("headers"), vendor.faults());
  for (const auto& [name, ignored] : *members) {
    const auto text = read_header(headers, name);
    if (text) into.texts["headers"].push_back(name + ":" + *text);
  }
}

const std::string* only_text(const VendorCommands& vendor, const std::string& key) {
  const auto at = vendor.texts.find(key);
  return at == vendor.texts.end() || at->second.empty() ? nullptr : &at->second.front();
}

}  // namespace

void read_http_json_keys(ObjectReader& vendor, VendorCommands& into) {
  if (const auto poll_s = vendor.number("poll_s", Need::optional, kPoll)) into.numbers["poll_s"] = *poll_s;
  if (const auto timeout_s = vendor.number("timeout_s", Need::optional, kTimeout))
    into.numbers["timeout_s"] = *timeout_s;
  read_hold_key(vendor, into);
  read_tls_key(vendor, into);
  const auto body = vendor.choice("body", Need::optional, {"json", "form"});
  if (body && *body == 1) into.texts["body"] = {"form"};
  if (const auto cookies = vendor.boolean("cookies", Need::optional)) into.numbers["cookies"] = *cookies ? 1 : 0;
  if (const auto sign_out = vendor.text("sign_out", Need::optional, kMaxHeader)) into.texts["sign_out"] = {*sign_out};
  read_headers(vendor, into);
}

HttpTiming http_timing(const VendorCommands& vendor) {
  HttpTiming timing;
  if (const auto at = vendor.numbers.find("poll_s"); at != vendor.numbers.end()) timing.poll_s = at->second;
  if (const auto at = vendor.numbers.find("timeout_s"); at != vendor.numbers.end()) timing.timeout_s = at->second;
  return timing;
}

HttpBody http_body(const VendorCommands& vendor) {
  return only_text(vendor, "body") == nullptr ? HttpBody::json : HttpBody::form;
}

std::string type_of(HttpBody body) {
  return body == HttpBody::json ? "application/json" : "application/x-www-form-urlencoded";
}

bool keeps_http_cookies(const VendorCommands& vendor) {
  const auto at = vendor.numbers.find("cookies");
  return at != vendor.numbers.end() && at->second != 0;
}

std::string http_sign_out(const VendorCommands& vendor) {
  const std::string* text = only_text(vendor, "sign_out");
  return text == nullptr ? std::string() : *text;
}

HttpFields http_headers(const VendorCommands& vendor) {
  HttpFields out;
  const auto at = vendor.texts.find("headers");
  if (at == vendor.texts.end()) return out;
  for (const std::string& one : at->second) {
    const std::size_t colon = one.find(':');
    out.emplace_back(one.substr(0, colon), one.substr(colon + 1));
  }
  return out;
}

bool same_header(std::string_view one, std::string_view other) {
  return std::ranges::equal(one, other, [](char a, char b) { return small(a) == small(b); });
}

}  // namespace trb::drivers
