#include "tests/bench/road/ends.hpp"

#include <array>
#include <cstdio>
#include <stdexcept>

#include "common/base/hex.hpp"
#include "common/security/keys.hpp"
#include "common/transport/loop.hpp"
#include "common/transport/zap.hpp"

namespace trb::bench {
namespace {

Socket value_of(Result<Socket> socket) {
  if (!socket) throw std::runtime_error(socket.error().text());
  return std::move(*socket);
}

/// Finally sends what was refused: a socket notices only now and then that its peer has room, unless it is polled.
template <class F>
void insist(Socket& socket, const F& send) {
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(2);
  std::array<zmq::pollitem_t, 1> items{{{socket.handle(), 0, ZMQ_POLLOUT, 0}}};
  do {
    if (send() == SendResult::sent) return;
    zmq::poll(items, std::chrono::milliseconds(10));
  } while (std::chrono::steady_clock::now() < end);
  throw std::runtime_error("a message was refused: the queue is full or the peer gone");
}

/// A client's first message; it also shows when the connection is up, since an unconnected socket refuses it.
void say_hello(Socket& socket) {
  insist(socket, [&] { return socket.send(Frame()); });
}

class ClientEnd final : public End {
 public:
  explicit ClientEnd(Socket socket) : socket_(std::move(socket)) { say_hello(socket_); }
  bool receive(Frame& frame) override { return socket_.receive(frame); }
  void send(Frame&& frame) override {
    if (socket_.send(std::move(frame)) == SendResult::sent) return;
    // NOLINTNEXTLINE(bugprone-use-after-move): a socket that is full has taken nothing
    insist(socket_, [&] { return socket_.send(std::move(frame)); });
  }
  zmq::pollitem_t item() override { return {socket_.handle(), 0, ZMQ_POLLIN, 0}; }

 private:
  Socket socket_;
};

class ServerEnd final : public End {
 public:
  explicit ServerEnd(Socket socket) : socket_(std::move(socket)) {}
  bool receive(Frame& frame) override {
    while (socket_.receive(routing_id_)) {
      if (!socket_.receive(frame)) return false;
      if (!frame.empty()) return true;
      client_ = view_of(routing_id_);
    }
    return false;
  }
  void send(Frame&& frame) override {
    if (socket_.send_to(client_, std::move(frame)) == SendResult::sent) return;
    // NOLINTNEXTLINE(bugprone-use-after-move): a socket that is full has taken nothing
    insist(socket_, [&] { return socket_.send_to(client_, std::move(frame)); });
  }
  zmq::pollitem_t item() override { return {socket_.handle(), 0, ZMQ_POLLIN, 0}; }

 private:
  Socket socket_;
  Frame routing_id_;
  Bytes client_;
};

/// ZAP is asked once per connection: the loop that serves it is not needed afterwards.
void admit_one(Context& context, Socket& inbox) {
  Loop loop;
  const ZapServer zap(context, loop, [](BytesView, BytesView) { return true; });
  loop.add_socket(inbox.handle(), [&loop] { loop.stop(); });
  loop.run();
}

}  // namespace

bool End::wait(std::chrono::milliseconds longest) {
  std::array<zmq::pollitem_t, 1> items{item()};
  return zmq::poll(items, longest) > 0;
}

std::unique_ptr<End> bus_client(Context& context, const std::string& path) {
  return std::make_unique<ClientEnd>(Socket::bus_client(context, "ipc://" + path));
}

std::unique_ptr<End> bus_server(Context& context, const std::string& path) {
  return std::make_unique<ServerEnd>(value_of(Socket::bus_server(context, "ipc://" + path)));
}

std::unique_ptr<End> curve_server(Context& context, const std::string& address) {
  const LinkKey key = make_link_key();
  Socket socket = value_of(Socket::inbox(context, "tcp://" + address, {key.public_key, key.secret_key}));
  std::printf("listening %s\n", to_hex(key.public_key).c_str());
  std::fflush(stdout);
  admit_one(context, socket);
  return std::make_unique<ServerEnd>(std::move(socket));
}

std::unique_ptr<End> curve_client(Context& context, const std::string& address, const std::string& server_key) {
  const auto key = from_hex(server_key);
  if (!key || key->size() != 32) throw std::runtime_error("the server's key is no 64 hexadecimal digits");
  const LinkKey own = make_link_key();
  Socket socket = value_of(Socket::dialler(context, {own.public_key, own.secret_key}, *key));
  if (const Status dialled = socket.dial("tcp://" + address); !dialled)
    throw std::runtime_error(dialled.error().text());
  return std::make_unique<ClientEnd>(std::move(socket));
}

std::unique_ptr<End> plain_server(Context& context, const std::string& address) {
  return std::make_unique<ServerEnd>(value_of(Socket::bus_server(context, "tcp://" + address)));
}

std::unique_ptr<End> plain_client(Context& context, const std::string& address) {
  return std::make_unique<ClientEnd>(Socket::bus_client(context, "tcp://" + address));
}

}  // namespace trb::bench
