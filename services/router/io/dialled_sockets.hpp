// The sockets that this node has dialled, one for a link, each with its monitor.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "common/transport/monitor.hpp"
#include "services/router/io/shell_context.hpp"

namespace trb::router {

struct DialledSocket {
  std::unique_ptr<Socket> socket;
  std::unique_ptr<SocketMonitor> monitor;
};

/// `Row`: a DialledSocket, with what else its owner keeps of it.
template <class Row>
class DialledSockets {
 public:
  explicit DialledSockets(ShellContext& shell) : shell_(shell) {}

  /// nullptr: none was dialled for that link.
  [[nodiscard]] const Row* find(LinkId link) const {
    const auto at = rows_.find(link);
    return at == rows_.end() ? nullptr : &at->second;
  }
  /// Watches the socket; its owner adds it to the loop, and dials. Errors: io_error (no descriptor is left).
  Status add(LinkId link, Row row, Socket socket, SocketMonitor::OnEvent on_event) {
    row.socket = std::make_unique<Socket>(std::move(socket));
    auto monitor = SocketMonitor::watch(shell_.zmq(), shell_.loop(), *row.socket, std::move(on_event));
    if (!monitor) return monitor.error();
    row.monitor = std::move(*monitor);
    rows_[link] = std::move(row);
    return Done{};
  }
  void close(LinkId link) {
    const auto at = rows_.find(link);
    if (at == rows_.end()) return;
    shell_.loop().remove_socket(at->second.socket->handle());
    closed_.push_back(std::move(at->second));
    rows_.erase(at);
  }
  /// Between turns: a monitor must not die inside its own call.
  void free_closed() { closed_.clear(); }

 private:
  ShellContext& shell_;
  std::map<LinkId, Row> rows_;
  std::vector<Row> closed_;
};

}  // namespace trb::router
