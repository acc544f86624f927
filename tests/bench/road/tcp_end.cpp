#include "tests/bench/road/tcp_end.hpp"

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <thread>

namespace trb::bench {
namespace {

constexpr int kTries = 500;
constexpr std::chrono::milliseconds kBetweenTries{10};

[[noreturn]] void give_up(const std::string& what) {
  throw std::runtime_error(what + ": " + std::strerror(errno));
}

sockaddr_in system_address(const std::string& host, std::uint16_t port) {
  sockaddr_in out{};
  out.sin_family = AF_INET;
  out.sin_port = htons(port);
  if (::inet_pton(AF_INET, host.c_str(), &out.sin_addr) != 1) throw std::runtime_error(host + ": no IPv4 address");
  return out;
}

void bind_to(int fd, const sockaddr_in& address) {
  const int on = 1;
  ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
  if (::bind(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) != 0) give_up("bind");
}

int tcp_socket() {
  const int fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (fd < 0) give_up("socket");
  return fd;
}

class TcpEnd final : public End {
 public:
  TcpEnd(int fd, std::string head) : fd_(fd), head_(std::move(head)) {
    const int on = 1;
    ::setsockopt(fd_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  ~TcpEnd() override { ::close(fd_); }

  bool receive(Frame& frame) override {
    if (take_line(frame)) return true;
    std::array<char, 65536> buffer;
    const ssize_t got = ::recv(fd_, buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (got == 0) throw std::runtime_error("the connection was closed");
    if (got < 0 && errno != EAGAIN && errno != EINTR) give_up("recv");
    if (got <= 0) return false;
    input_.erase(0, std::exchange(taken_, 0));
    input_.append(buffer.data(), static_cast<std::size_t>(got));
    return take_line(frame);
  }

  void send(Frame&& frame) override {
    output_ += head_;
    output_ += view_of(frame);
    output_ += '\n';
  }

  void flush() override {
    std::size_t done = 0;
    while (done < output_.size()) {
      const ssize_t put = ::send(fd_, output_.data() + done, output_.size() - done, MSG_NOSIGNAL);
      if (put < 0 && errno != EINTR) give_up("send");
      if (put > 0) done += static_cast<std::size_t>(put);
    }
    output_.clear();
  }

  zmq::pollitem_t item() override { return {nullptr, fd_, ZMQ_POLLIN, 0}; }

 private:
  bool take_line(Frame& frame) {
    const std::size_t end = input_.find('\n', taken_);
    if (end == std::string::npos) return false;
    frame.rebuild(input_.data() + taken_, end - taken_);
    taken_ = end + 1;
    return true;
  }

  int fd_;
  std::string head_;
  std::string input_;
  std::size_t taken_ = 0;
  std::string output_;
};

}  // namespace

TcpAddress tcp_address(const std::string& text) {
  const std::size_t colon = text.rfind(':');
  if (colon == std::string::npos) throw std::runtime_error(text + ": no HOST:PORT");
  return {text.substr(0, colon), static_cast<std::uint16_t>(std::stoi(text.substr(colon + 1)))};
}

int tcp_listen(const TcpAddress& at) {
  const int fd = tcp_socket();
  bind_to(fd, system_address(at.host, at.port));
  if (::listen(fd, 1) != 0) give_up("listen");
  std::puts("listening");
  std::fflush(stdout);
  return fd;
}

int tcp_accept(int listener) {
  const int fd = ::accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
  if (fd < 0) give_up("accept");
  ::close(listener);
  return fd;
}

int tcp_dial(const TcpAddress& to, const std::string& from) {
  const sockaddr_in address = system_address(to.host, to.port);
  for (int i = 0; i < kTries; ++i) {
    const int fd = tcp_socket();
    if (!from.empty()) bind_to(fd, system_address(from, 0));
    if (::connect(fd, reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0) return fd;
    ::close(fd);
    std::this_thread::sleep_for(kBetweenTries);
  }
  give_up(to.host);
}

std::unique_ptr<End> tcp_end(int fd, std::string head) {
  return std::make_unique<TcpEnd>(fd, std::move(head));
}

}  // namespace trb::bench
