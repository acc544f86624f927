// A node's own bus: the connections between its router and its services.
#pragma once

#include <functional>
#include <map>
#include <string>

#include "services/simulator/world/network.hpp"

namespace trb::world {

constexpr Duration kBusDelay = std::chrono::microseconds(100);

/// The router's end.
class BusServer {
 public:
  BusServer() = default;
  BusServer(const BusServer&) = delete;
  BusServer& operator=(const BusServer&) = delete;
  /// `name`: whom the socket proves.
  virtual void on_bus_frame(ConnectionId from, const std::string& name, Bytes frame) = 0;

 protected:
  ~BusServer() = default;
};

/// Carries frames both ways, in order. It ends with the node's processes; what was under way is lost.
class Bus {
 public:
  Bus(Events& events, BusServer& server) : events_(events), server_(server), life_(std::make_shared<char>()) {}

  ConnectionId connect(const std::string& name, std::function<void(Bytes)> receive) {
    connections_[++last_] = {name, std::move(receive)};
    return last_;
  }
  void to_router(ConnectionId from, Bytes frame) {
    events_.after(kBusDelay, life_, [this, from, frame = std::move(frame)]() mutable {
      server_.on_bus_frame(from, connections_.at(from).name, std::move(frame));
    });
  }
  /// False: there is no such connection.
  bool to_service(ConnectionId to, Bytes frame) {
    if (!connections_.contains(to)) return false;
    events_.after(kBusDelay, life_,
                  [this, to, frame = std::move(frame)]() mutable { connections_.at(to).receive(std::move(frame)); });
    return true;
  }

 private:
  struct Connection {
    std::string name;
    std::function<void(Bytes)> receive;
  };
  Events& events_;
  BusServer& server_;
  std::map<ConnectionId, Connection> connections_;
  ConnectionId last_ = 0;
  std::shared_ptr<char> life_;
};

}  // namespace trb::world
