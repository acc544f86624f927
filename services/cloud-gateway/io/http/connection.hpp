// One client's connection, as the server has it in its table.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "services/cloud-gateway/io/http/http_server.hpp"

namespace boost::asio::ssl {
class context;
}

namespace trb::gateway {

using ConnectionId = std::uint64_t;  ///< never used twice

/// A client's TLS connection: HTTP first, then perhaps a WebSocket.
class Connection {
 public:
  Connection() = default;
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;
  virtual ~Connection() = default;

  /// Since when it has waited for a request, or for the end of its handshake; nullopt: it does not.
  [[nodiscard]] virtual std::optional<std::chrono::steady_clock::time_point> idle_since() const = 0;
  /// The server stops: what is idle ends, what is under way is the last.
  virtual void finish() = 0;
  /// Cuts it off. The owner hears nothing more.
  virtual void abort() = 0;
};

/// The server, as its connections see it. It aborts them before it goes.
class ConnectionOwner {
 public:
  ConnectionOwner() = default;
  ConnectionOwner(const ConnectionOwner&) = delete;
  ConnectionOwner& operator=(const ConnectionOwner&) = delete;
  virtual ~ConnectionOwner() = default;

  virtual HttpHandler& handler() = 0;
  [[nodiscard]] virtual const HttpTimes& times() const = 0;
  [[nodiscard]] virtual bool is_stopping() const = 0;
  /// The connection goes on as this one.
  virtual void replace(ConnectionId id, std::shared_ptr<Connection> by) = 0;
  virtual void ended(ConnectionId id) = 0;
};

struct Accepted {
  ConnectionId id = 0;
  int socket = -1;  ///< becomes the connection's
  bool is_v6 = false;
  std::string source;
};

/// Begins with the TLS handshake. All of the templates of Boost.Beast's streams are compiled in its file alone.
std::shared_ptr<Connection> start_connection(boost::asio::io_context& loop, boost::asio::ssl::context& tls,
                                             ConnectionOwner& owner, Accepted accepted);

}  // namespace trb::gateway
