// The ends of a bench road: senders and receivers of messages of one frame, by ipc, CURVE or a robot's TCP.
#pragma once

#include <memory>
#include <string>
#include <zmq.hpp>

#include "common/transport/socket.hpp"

namespace trb::bench {

class End {
 public:
  End() = default;
  End(const End&) = delete;
  End& operator=(const End&) = delete;
  virtual ~End() = default;

  /// The next message, if there is one.
  virtual bool receive(Frame& frame) = 0;
  /// Throws if the message could not be sent: nothing may be lost.
  virtual void send(Frame&& frame) = 0;
  /// Sends what send() has only collected.
  virtual void flush() {}
  [[nodiscard]] virtual zmq::pollitem_t item() = 0;

  /// Waits until there may be something to receive; false if nothing came in this time.
  bool wait(std::chrono::milliseconds longest);
};

/// A service's end of the bus: a DEALER that connects by ipc, and sends an empty message so that it is known.
std::unique_ptr<End> bus_client(Context& context, const std::string& path);
/// The router's end of the bus: a ROUTER that binds by ipc; it sends to the client that it last received from.
std::unique_ptr<End> bus_server(Context& context, const std::string& path);
/// The inbox of a router, with ZAP. Prints "listening KEY" with its public key, then waits for its one client.
std::unique_ptr<End> curve_server(Context& context, const std::string& address);
/// A dialled link to the inbox with that key (hexadecimal).
std::unique_ptr<End> curve_client(Context& context, const std::string& address, const std::string& server_key);
/// The same two without encryption, for what CURVE costs.
std::unique_ptr<End> plain_server(Context& context, const std::string& address);
std::unique_ptr<End> plain_client(Context& context, const std::string& address);

}  // namespace trb::bench
