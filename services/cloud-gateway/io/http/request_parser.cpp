#include "services/cloud-gateway/io/http/request_parser.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/basic_parser.hpp>

#include "services/cloud-gateway/io/http/http_server.hpp"

namespace trb::gateway {
namespace {

namespace http = boost::beast::http;
using Word = boost::beast::string_view;
using Problem = boost::beast::error_code;

/// Keeps the header list as it is sent.
class HeadParser final : public http::basic_parser<true> {
 public:
  HeadParser() {
    skip(true);  // the request ends for it with the headers
    header_limit(kMaxRequestHead);
  }
  RawHead head;

 private:
  void on_request_impl(http::verb, Word method, Word target, int version, Problem&) override {
    head.method = std::string(method);
    head.target = std::string(target);
    head.version = version;
  }
  void on_field_impl(http::field, Word name, Word value, Problem&) override {
    head.headers.push_back({std::string(name), std::string(value)});
  }
  void on_response_impl(int, Word, int, Problem&) override {}
  void on_header_impl(Problem&) override {}
  void on_body_init_impl(const boost::optional<std::uint64_t>&, Problem&) override {}
  std::size_t on_body_impl(Word body, Problem&) override { return body.size(); }
  void on_chunk_header_impl(std::uint64_t, Word, Problem&) override {}
  std::size_t on_chunk_body_impl(std::uint64_t, Word body, Problem&) override { return body.size(); }
  void on_finish_impl(Problem&) override {}
};

HttpFault fault_of(const Problem& problem) {
  if (problem == http::error::header_limit)
    return {431, "head_too_large", "request line and headers over " + std::to_string(kMaxRequestHead) + " bytes",
            "send fewer or shorter headers, and remove this site's cookies"};
  if (problem == http::error::bad_version)
    return {505, "unknown_http_version", "neither HTTP/1.1 nor HTTP/1.0", "use HTTP/1.1"};
  return bad_request("not an HTTP request: " + problem.message(), "send it as RFC 9112 says");
}

}  // namespace

struct RequestParser::Impl {
  HeadParser parser;
  Problem problem;
  std::size_t taken = 0;
};

RequestParser::RequestParser() : impl_(std::make_unique<Impl>()) {}
RequestParser::~RequestParser() = default;

RequestParser::State RequestParser::feed(std::string& input) {
  const std::size_t used = impl_->parser.put(boost::asio::buffer(input.data(), input.size()), impl_->problem);
  input.erase(0, used);
  impl_->taken += used;
  // Beast bounds what it is given at once: headers that come one by one would never end.
  if (impl_->taken > kMaxRequestHead) impl_->problem = http::error::header_limit;
  if (impl_->problem == http::error::need_more) return State::more;
  return impl_->problem ? State::fault : State::done;
}

RawHead RequestParser::take() {
  return std::move(impl_->parser.head);
}

HttpFault RequestParser::fault() const {
  return fault_of(impl_->problem);
}

}  // namespace trb::gateway
