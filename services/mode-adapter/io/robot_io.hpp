// The robot's connections: the one that the robot dials (TCP_PORT) and those that the node dials (commands, monitor),
// over TCP or, as datagrams, over UDP.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "common/base/back_off.hpp"
#include "common/service/service.hpp"
#include "common/tls/tls_client.hpp"
#include "services/mode-adapter/core/adapter_core.hpp"
#include "services/mode-adapter/io/tcp.hpp"
#include "services/mode-adapter/io/waiting_bytes.hpp"

namespace trb::adapter {

struct RobotIoSettings {
  std::string listen_address;
  std::uint16_t listen_port = 0;
  std::string robot_host;  ///< empty: TCP_PORT accepts a connection from any host
  std::optional<std::uint16_t> command_port;
  std::optional<std::uint16_t> monitor_port;
  bool datagrams = false;  ///< dialled connections are UDP: each RobotWrite is one datagram, each datagram one on_bytes
  std::optional<std::uint16_t> data_port{};
  std::optional<TlsTrust> tls{};  ///< the commands' connection speaks TLS
};

class RobotIo {
 public:
  /// From now on it listens and dials. `service` and `core` must outlive it. Errors: bad_value, io_error.
  static Result<std::unique_ptr<RobotIo>> open(const RobotIoSettings& settings, Service& service,
                                               ModeAdapterCore& core);
  RobotIo(const RobotIo&) = delete;
  RobotIo& operator=(const RobotIo&) = delete;
  /// What was written last still leaves, as far as the robot takes it at once.
  ~RobotIo();

  /// Writes and closes what the core wants, on the channels that are open.
  void carry_out(const RobotOutbox& out);
  [[nodiscard]] std::uint16_t listen_port() const { return local_port(listener_.get()); }

 private:
  enum class State : std::uint8_t { down, connecting, securing, up };
  struct RobotConnection {
    Channel channel{};
    std::optional<std::uint16_t> port;  ///< dialled; none: the robot dials
    bool datagrams = false;
    Descriptor fd;
    State state = State::down;
    std::unique_ptr<TlsClient> tls;
    WaitingBytes output;  ///< as it is sent: with TLS, encrypted
    bool wants_write = false;
    bool has_written = false;                 ///< in this turn of the loop: further output is sent at its end
    std::optional<MonotonicTime> held_until;  ///< set: it is not read, for its messages have no room on the bus
    std::optional<MonotonicTime> due;         ///< down: when to dial; connecting, securing: when to give up
    BackOff back_off{std::chrono::milliseconds(100), std::chrono::seconds(2)};
    std::string last_failure;
  };
  struct Notice {
    Channel channel{};
    std::string reason;
    bool is_new = true;  ///< worth a line in the log
  };

  RobotIo(const RobotIoSettings& settings, Service& service, ModeAdapterCore& core, Descriptor listener);
  static bool is_open(const RobotConnection& connection) { return connection.state >= State::securing; }
  RobotConnection& connection(Channel channel) { return connections_[static_cast<std::size_t>(channel)]; }

  void accept_all();
  void take_in(Accepted accepted);
  void dial(RobotConnection& connection);
  void dial_datagrams(RobotConnection& connection);
  void on_dialled(RobotConnection& connection);
  void begin_tls(RobotConnection& connection);
  void come_up(RobotConnection& connection);
  void on_ready(RobotConnection& connection, short revents);
  [[nodiscard]] bool must_wait(const RobotConnection& connection) const;
  void hold_back(RobotConnection& connection);
  void go_on(RobotConnection& connection, MonotonicTime now);
  void read(RobotConnection& connection);
  void end_if_left(RobotConnection& connection);
  void read_datagram(RobotConnection& connection);
  void receive(RobotConnection& connection, std::size_t size);
  void receive_encrypted(RobotConnection& connection, BytesView bytes);
  void hand_in(RobotConnection& connection, BytesView bytes);
  static bool is_new_reason(const RobotConnection& connection, const std::string& reason);
  void go_down(RobotConnection& connection, const std::string& reason, const std::string& cure = {});
  void close(RobotConnection& connection);
  void retry_later(RobotConnection& connection);

  void write(RobotConnection& connection, BytesView bytes);
  bool flush(RobotConnection& connection);
  bool push(RobotConnection& connection);
  void say_last(RobotConnection& connection);
  void watch(RobotConnection& connection);
  void notice_loss(RobotConnection& connection, const std::string& reason);

  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  void tick(Now now);
  void report_losses();

  RobotIoSettings settings_;
  Service& service_;
  ModeAdapterCore& core_;
  Descriptor listener_;
  std::array<RobotConnection, 4> connections_;
  std::vector<Notice> losses_;  ///< found while writing the core's output; reported in a step of their own
  Bytes buffer_;
};

}  // namespace trb::adapter
