#include "services/router/io/metrics_port.hpp"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/buffer.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/parser.hpp>
#include <cerrno>
#include <cstring>

namespace trb::router {
namespace {

namespace http = boost::beast::http;

std::string reply_of(std::string_view status, std::string_view type, const std::string& body) {
  return "HTTP/1.1 " + std::string(status) + "\r\nContent-Type: " + std::string(type) +
         "; charset=utf-8\r\nContent-Length: " + std::to_string(body.size()) +
         "\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n" + body;
}

std::string refusal(std::string_view status, const std::string& why) {
  return reply_of(status, "text/plain", why + "\n");
}

sockaddr_in address_of(const MetricsAddress& at) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(at.port);
  ::inet_pton(AF_INET, at.address.c_str(), &out.sin_addr);
  return out;
}

bool is_over(ssize_t size) {
  return size == 0 || (size < 0 && errno != EAGAIN && errno != EINTR);
}

}  // namespace

std::string metrics_reply(const std::string& request, const std::string& host,
                          const std::function<std::string()>& text) {
  http::request_parser<http::empty_body> parser;
  parser.header_limit(MetricsPort::kMostBytes);
  boost::system::error_code problem;
  parser.put(boost::asio::buffer(request), problem);
  if (problem == http::error::need_more) return "";
  if (problem || !parser.is_header_done()) return refusal("400 Bad Request", "this is no request: GET /metrics");
  const auto& head = parser.get();
  const std::string said(head[http::field::host]);
  const std::string port = host.substr(host.find(':'));
  if (said != host && said != "localhost" + port)
    return refusal("403 Forbidden", "ask for http://" + host + "/metrics");
  if (head.target() != "/metrics") return refusal("404 Not Found", "there is /metrics alone");
  if (head.method() != http::verb::get) return refusal("405 Method Not Allowed\r\nAllow: GET", "GET alone is served");
  return reply_of("200 OK", "text/plain; version=0.0.4", text());
}

MetricsPort::MetricsPort(Loop& loop, std::function<std::string()> text) : loop_(loop), text_(std::move(text)) {}

MetricsPort::~MetricsPort() {
  while (!connections_.empty()) cut(connections_.begin()->first);
  if (listener_ < 0) return;
  loop_.remove_fd(listener_);
  ::close(listener_);
}

Status MetricsPort::open(const MetricsAddress& at) {
  host_ = at.address + ":" + std::to_string(at.port);
  const sockaddr_in here = address_of(at);
  const int one = 1;
  listener_ = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const bool listens = listener_ >= 0 && ::setsockopt(listener_, SOL_SOCKET, SO_REUSEADDR, &one, sizeof one) == 0 &&
                       ::bind(listener_, reinterpret_cast<const sockaddr*>(&here), sizeof here) == 0 &&
                       ::listen(listener_, kMost) == 0;
  if (!listens) {
    return fail(Errc::io_error, "metrics.json: listen: " + host_ + ": " + std::strerror(errno),
                "name another port there (ss -ltnp shows who has this one)");
  }
  loop_.add_fd(listener_, POLLIN, [this](short) { accept(); });
  loop_.add_timer([this] { return next(); }, [this](Now now) { cut_late(now.mono); });
  return Done{};
}

/// One a turn. Of too many the oldest goes: whoever holds them open keeps nobody else out.
void MetricsPort::accept() {
  const int fd = ::accept4(listener_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
  if (fd < 0) return;
  if (connections_.size() == kMost) {
    const auto older = [](const auto& a, const auto& b) { return a.second.until < b.second.until; };
    cut(std::ranges::min_element(connections_, older)->first);
  }
  connections_[fd].until = read_clocks().mono + kPatience;
  loop_.add_fd(fd, POLLIN, [this, fd](short revents) { serve(fd, revents); });
}

void MetricsPort::serve(int fd, short revents) {
  const auto found = connections_.find(fd);
  if (found == connections_.end()) return;
  if ((revents & POLLERR) != 0) return cut(fd);
  if (found->second.out.empty()) {
    read(fd, found->second);
  } else {
    write(fd, found->second);
  }
}

void MetricsPort::read(int fd, Connection& connection) {
  char buffer[kMostBytes];
  const ssize_t size = ::recv(fd, buffer, sizeof buffer, 0);
  if (is_over(size)) return cut(fd);
  if (size < 0) return;
  connection.in.append(buffer, static_cast<std::size_t>(size));
  if (connection.in.size() > kMostBytes) return cut(fd);
  connection.out = metrics_reply(connection.in, host_, text_);
  if (connection.out.empty()) return;
  loop_.add_fd(fd, POLLOUT, [this, fd](short revents) { serve(fd, revents); });
  write(fd, connection);
}

void MetricsPort::write(int fd, Connection& connection) {
  const ssize_t size = ::send(fd, connection.out.data(), connection.out.size(), MSG_NOSIGNAL);
  if (is_over(size)) return cut(fd);
  if (size > 0) connection.out.erase(0, static_cast<std::size_t>(size));
  if (connection.out.empty()) cut(fd);
}

void MetricsPort::cut(int fd) {
  loop_.remove_fd(fd);
  connections_.erase(fd);
  ::close(fd);
}

void MetricsPort::cut_late(MonotonicTime now) {
  while (const auto due = next()) {
    if (*due > now) return;
    const auto late = std::ranges::find_if(connections_, [&](const auto& one) { return one.second.until <= now; });
    cut(late->first);
  }
}

std::optional<MonotonicTime> MetricsPort::next() const {
  std::optional<MonotonicTime> out;
  for (const auto& [fd, connection] : connections_) out = earlier(out, connection.until);
  return out;
}

}  // namespace trb::router
