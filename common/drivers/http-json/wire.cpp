#include "common/drivers/http-json/wire.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>
#include <string_view>

#include "common/config/robot_tls.hpp"

namespace trb::drivers {

namespace http = boost::beast::http;

constexpr std::string_view kLastChunk = "0\r\n\r\n";
/// How a TLS server answers what is no TLS.
constexpr std::string_view kTlsAlert = "\x15\x03";
/// It begins with kTlsFailed.
constexpr const char* kSpeaksTls = "TLS: the robot's port speaks it, and commands.json has no \"tls\"";

namespace {

std::vector<std::string> values_of(const http::fields& fields, http::field name) {
  std::vector<std::string> out;
  const auto [begin, end] = fields.equal_range(name);
  for (auto at = begin; at != end; ++at) out.emplace_back(at->value());
  return out;
}

}  // namespace

struct HttpReader::Parser {
  http::response_parser<http::string_body> of;

  Parser() {
    of.eager(true);
    of.body_limit(kMaxBody);
    of.header_limit(kMaxHeader);
  }
};

Bytes encode(const HttpRequest& request, const HttpFields& fields) {
  Bytes out = request.method + " " + request.target + " HTTP/1.1\r\n";
  for (const auto& [name, value] : fields) out.append(name).append(": ").append(value).append("\r\n");
  if (!request.body.empty() || request.method != "GET")
    out += "Content-Length: " + std::to_string(request.body.size()) + "\r\n";
  return out + "\r\n" + request.body;
}

HttpReader::HttpReader() : parser_(std::make_unique<Parser>()) {}
HttpReader::~HttpReader() = default;

void HttpReader::clear() {
  parser_ = std::make_unique<Parser>();
  rest_.clear();
}

Result<std::vector<HttpAnswer>> HttpReader::add(BytesView bytes) {
  std::vector<HttpAnswer> out;
  rest_ += bytes;
  while (!rest_.empty()) {
    // Beast 1.74 asserts if the last chunk comes in pieces. Before it has come whole, no chunked answer is over.
    if (parser_->of.is_header_done() && parser_->of.chunked() && rest_.size() < kLastChunk.size()) break;
    if (!parser_->of.got_some() && BytesView(rest_).starts_with(kTlsAlert))
      return fail(Errc::malformed, kSpeaksTls, kTlsCure);
    boost::system::error_code problem;
    const std::size_t taken = parser_->of.put(boost::asio::buffer(rest_.data(), rest_.size()), problem);
    rest_.erase(0, taken);
    const auto& of = parser_->of;
    const bool long_body = (of.is_header_done() && of.content_length() && *of.content_length() > kMaxBody) ||
                           of.get().body().size() > kMaxBody;
    if (long_body) return fail(Errc::too_large, "an answer over 1 MiB", "ask for less of it");
    if (problem && problem != http::error::need_more) {
      const bool large = problem == http::error::body_limit || problem == http::error::header_limit ||
                         problem == http::error::buffer_overflow;
      return fail(large ? Errc::too_large : Errc::malformed, "no answer of HTTP: " + problem.message(),
                  "look at the robot's address and port");
    }
    if (!parser_->of.is_done()) {
      if (taken == 0 || problem == http::error::need_more) break;
      continue;
    }
    take(out);
  }
  return out;
}

std::vector<HttpAnswer> HttpReader::end() {
  std::vector<HttpAnswer> out;
  boost::system::error_code problem;
  if (parser_->of.got_some() && !parser_->of.is_done()) parser_->of.put_eof(problem);
  if (!problem && parser_->of.is_done()) take(out);
  clear();
  return out;
}

void HttpReader::take(std::vector<HttpAnswer>& out) {
  const bool closes = !parser_->of.keep_alive();
  auto message = parser_->of.release();
  const unsigned status = message.result_int();
  parser_ = std::make_unique<Parser>();
  if (status < 200) return;  // the answer follows
  out.push_back({status, std::move(message.body()), closes, values_of(message, http::field::www_authenticate),
                 values_of(message, http::field::set_cookie)});
}

}  // namespace trb::drivers
