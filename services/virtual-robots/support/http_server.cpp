#include "services/virtual-robots/support/http_server.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/http/parser.hpp>
#include <boost/beast/http/string_body.hpp>

#include "services/virtual-robots/support/process.hpp"

namespace trb::virtual_robots {
namespace {

namespace http = boost::beast::http;

constexpr std::size_t kMostClients = 16;

std::string lower(std::string text) {
  for (char& c : text) c = c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c;
  return text;
}

HttpRequest request_of(const http::request<http::string_body>& from) {
  HttpRequest request{std::string(from.method_string()), std::string(from.target()), {}, from.body()};
  for (const auto& field : from) request.headers[lower(std::string(field.name_string()))] = std::string(field.value());
  return request;
}

}  // namespace

struct HttpServer::Intake {
  std::unique_ptr<http::request_parser<http::string_body>> parser;

  Intake() { restart(); }
  void restart() {
    parser = std::make_unique<http::request_parser<http::string_body>>();
    parser->eager(true);
    parser->body_limit(65536);
  }
};

std::string HttpRequest::header(const std::string& name) const {
  const auto at = headers.find(name);
  return at == headers.end() ? std::string() : at->second;
}

HttpServer::HttpServer(const Endpoint& where, Answer answer)
    : answer_(std::move(answer)), server_(where, kMostClients) {}

HttpServer::~HttpServer() = default;

void HttpServer::serve(const std::vector<pollfd>& polled) {
  server_.serve(polled, [this](TcpServer::Client& client) { take(client); });
  std::erase_if(intakes_, [this](const auto& one) { return server_.find(one.first) == nullptr; });
}

void HttpServer::take(TcpServer::Client& client) {
  auto& intake = intakes_[client.id];
  if (!intake) intake = std::make_unique<Intake>();
  while (!client.input.empty()) {
    auto& parser = *intake->parser;
    boost::system::error_code problem;
    const std::size_t taken = parser.put(boost::asio::buffer(client.input.data(), client.input.size()), problem);
    client.input.erase(0, taken);
    if (problem && problem != http::error::need_more) return client.drop("no_http");
    if (!parser.is_done()) {
      if (taken == 0 || problem) return;
      continue;
    }
    const bool stays = parser.keep_alive();
    reply(client, answer_(request_of(parser.get())), stays);
    intake->restart();
    if (!stays) return client.drop("closed");
  }
}

void HttpServer::reply(TcpServer::Client& client, const HttpReply& reply, bool stays) {
  std::string head = "HTTP/1.1 " + std::to_string(reply.status) + " " +
                     std::string(http::obsolete_reason(http::int_to_status(reply.status))) + "\r\n";
  for (const auto& [name, value] : reply.headers) head += name + ": " + value + "\r\n";
  if (!reply.body.empty()) head += "Content-Type: application/json\r\n";
  if (reply.status != 204) head += "Content-Length: " + std::to_string(reply.body.size()) + "\r\n";
  server_.send(client, head + (stays ? "" : "Connection: close\r\n") + "\r\n" + reply.body);
  if (http::to_status_class(reply.status) != http::status_class::successful)
    print_line("refused " + std::to_string(reply.status));
}

}  // namespace trb::virtual_robots
