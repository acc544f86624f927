// The sockets that this node has dialled, one for a link, each with its monitor and the descriptor of its connection.
#pragma once

#include <map>
#include <memory>
#include <utility>
#include <vector>

#include "common/transport/incomplete_bytes.hpp"
#include "common/transport/monitor.hpp"
#include "common/transport/source_filter.hpp"
#include "services/router/io/look_round.hpp"
#include "services/router/io/shell_context.hpp"

namespace trb::router {

struct DialledSocket {
  std::unique_ptr<Socket> socket;
  std::unique_ptr<SocketMonitor> monitor;
  int fd = -1;  ///< of its connection, once there is one
  RemoteEnd end;
  IncompleteBytes incomplete;  ///< its owner adds what it receives
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
  [[nodiscard]] Row* find(LinkId link) {
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
  /// Its connection has this descriptor.
  void reached(LinkId link, int fd) {
    Row* row = find(link);
    const auto end = remote_end(fd);
    if (row == nullptr || !end) return;
    row->fd = fd;
    row->end = *end;
  }
  [[nodiscard]] std::size_t size() const { return rows_.size(); }
  /// Those of this part that may send messages without a last part: to be read until they are empty, for
  /// ends_incomplete().
  [[nodiscard]] std::vector<LinkId> look(const LookPart& part) {
    std::vector<LinkId> suspected;
    cursor_.visit(rows_, part, [&](LinkId link, Row& row) {
      const auto read = row.fd < 0 ? std::nullopt : bytes_read(row.fd);
      if (read && row.incomplete.look(*read)) suspected.push_back(link);
    });
    // Another connection may have had the descriptor by then: this one's end is reported first.
    for (const LinkId link : suspected) {
      if (Row* row = find(link)) row->monitor->catch_up();
    }
    return suspected;
  }
  /// The socket had no message left. True: it sent messages without a last part, and was cut.
  bool ends_incomplete(Row& row) {
    if (!row.incomplete.on_empty() || !is_connection(row.fd, row.end)) return false;
    cut_connection(row.fd, row.end);
    return true;
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
  LookCursor cursor_;
  std::vector<Row> closed_;
};

}  // namespace trb::router
