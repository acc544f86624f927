#include "services/mode-adapter/io/robot_io.hpp"

#include <poll.h>

#include <algorithm>
#include <utility>

#include "common/config/robot_tls.hpp"
#include "services/mode-adapter/io/udp.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kReadSize = 64U << 10U;
/// A robot for which this much waits has stopped reading. One message always fits, whatever its size.
constexpr std::size_t kMaxWaiting = 1U << 20U;
/// A robot is not read for longest, though the bus has no room: among its words may be the answer to a stop.
constexpr Duration kLongestHold = std::chrono::milliseconds(500);
/// What a robot that has left wrote last; the kernel holds a few megabytes.
constexpr int kMostLastReads = 256;
constexpr int kAcceptBatch = 16;
constexpr Duration kConnectTimeout = std::chrono::seconds(2);
/// A small controller reckons with large keys for a second or two.
constexpr Duration kHandshakeTimeout = std::chrono::seconds(5);

}  // namespace

Result<std::unique_ptr<RobotIo>> RobotIo::open(const RobotIoSettings& settings, Service& service,
                                               ModeAdapterCore& core) {
  auto listener = tcp_listen(settings.listen_address, settings.listen_port);
  if (!listener) return listener.error();
  return std::unique_ptr<RobotIo>(new RobotIo(settings, service, core, std::move(*listener)));
}

RobotIo::RobotIo(const RobotIoSettings& settings, Service& service, ModeAdapterCore& core, Descriptor listener)
    : settings_(settings), service_(service), core_(core), listener_(std::move(listener)), buffer_(kReadSize, '\0') {
  connection(Channel::field).channel = Channel::field;
  connection(Channel::command).channel = Channel::command;
  connection(Channel::command).port = settings.command_port;
  connection(Channel::monitor).channel = Channel::monitor;
  connection(Channel::monitor).port = settings.monitor_port;
  connection(Channel::data).channel = Channel::data;
  connection(Channel::data).port = settings.data_port;
  for (RobotConnection& dialled : connections_) {
    dialled.datagrams = settings.datagrams && dialled.port;
    if (dialled.port) dialled.due = now().mono;
  }
  service_.watch(listener_.get(), POLLIN, [this](short) { accept_all(); });
  service_.timer([this] { return next_deadline(); }, [this](Now at) { tick(at); });
}

RobotIo::~RobotIo() {
  for (RobotConnection& open : connections_) {
    say_last(open);  // a process that ends has just told its robot to stand
    close(open);
  }
  service_.unwatch(listener_.get());
}

void RobotIo::accept_all() {
  report_losses();
  for (int i = 0; i < kAcceptBatch; ++i) {
    Accepted accepted = tcp_accept(listener_.get());
    if (!accepted.fd) return;
    take_in(std::move(accepted));
  }
}

void RobotIo::take_in(Accepted accepted) {
  const bool stranger = !settings_.robot_host.empty() && accepted.peer != settings_.robot_host;
  RobotConnection& field = connection(Channel::field);
  if (!stranger) end_if_left(field);
  if (stranger || field.state == State::up) {
    const std::string why = stranger ? ": robot.host is " + settings_.robot_host : ": the robot is connected already";
    service_.step([&](Now, Outbox& out) {
      out.count("refused.field_client");
      out.log(LogLevel::warning, "field_client_refused", accepted.peer + why);
    });
    return;
  }
  field.fd = std::move(accepted.fd);
  watch_over(field.fd.get());
  come_up(field);
}

void RobotIo::dial(RobotConnection& connection) {
  if (connection.datagrams) return dial_datagrams(connection);
  auto dialled = tcp_dial(settings_.robot_host, *connection.port);
  if (!dialled) return go_down(connection, dialled.error().what);
  connection.fd = std::move(*dialled);
  connection.state = State::connecting;
  connection.due = now().mono + kConnectTimeout;
  service_.watch(connection.fd.get(), POLLOUT, [this, &connection](short) { on_dialled(connection); });
}

/// UDP has no handshake: the connection is up, and only the robot's data shows whether it is there.
void RobotIo::dial_datagrams(RobotConnection& connection) {
  auto dialled = udp_dial(settings_.robot_host, *connection.port);
  if (!dialled) return go_down(connection, dialled.error().what);
  connection.fd = std::move(*dialled);
  connection.state = State::up;
  connection.due.reset();
  watch(connection);
  service_.step([&](Now at, Outbox& out) { core_.on_channel_up(connection.channel, at, out); });
}

void RobotIo::on_dialled(RobotConnection& connection) {
  if (const Status connected = tcp_connected(connection.fd.get()); !connected)
    return go_down(connection, connected.error().what);
  if (connection.channel == Channel::command && settings_.tls) return begin_tls(connection);
  come_up(connection);
}

void RobotIo::begin_tls(RobotConnection& connection) {
  auto client = TlsClient::make(*settings_.tls);
  if (!client) return go_down(connection, client.error().what, client.error().hint);
  connection.tls = std::move(*client);
  connection.state = State::securing;
  connection.due = now().mono + kHandshakeTimeout;
  watch(connection);
  receive_encrypted(connection, {});
}

void RobotIo::come_up(RobotConnection& connection) {
  connection.state = State::up;
  connection.due.reset();
  connection.last_failure.clear();
  connection.wants_write = !connection.output.empty();
  watch(connection);
  service_.step([&](Now at, Outbox& out) {
    out.log(LogLevel::info, "robot_connected", std::string(name_of(connection.channel)));
    core_.on_channel_up(connection.channel, at, out);
  });
}

void RobotIo::watch(RobotConnection& connection) {
  const int reads = connection.held_until ? 0 : POLLIN;
  const auto events = static_cast<short>(connection.wants_write ? reads | POLLOUT : reads);
  // A connection that is watched for nothing still signals its end, again and again.
  if (events == 0) return service_.unwatch(connection.fd.get());
  service_.watch(connection.fd.get(), events, [this, &connection](short revents) { on_ready(connection, revents); });
}

void RobotIo::on_ready(RobotConnection& connection, short revents) {
  report_losses();
  if (!is_open(connection)) return;
  if ((revents & POLLOUT) != 0 && !flush(connection)) return report_losses();
  if ((revents & (POLLIN | POLLERR | POLLHUP)) == 0) return;
  if (must_wait(connection)) return hold_back(connection);
  read(connection);
}

/// Only the robot's own messages come in bursts: what a controller tells is asked for.
bool RobotIo::must_wait(const RobotConnection& connection) const {
  return connection.channel == Channel::field && !service_.has_room();
}

/// TCP holds the robot back.
void RobotIo::hold_back(RobotConnection& connection) {
  if (connection.held_until) return;
  connection.held_until = now().mono + kLongestHold;
  watch(connection);
}

void RobotIo::go_on(RobotConnection& connection, MonotonicTime now) {
  if (!connection.held_until || (must_wait(connection) && now < *connection.held_until)) return;
  connection.held_until.reset();
  watch(connection);
  read(connection);
}

void RobotIo::read(RobotConnection& connection) {
  if (connection.datagrams) return read_datagram(connection);
  const auto got = tcp_read(connection.fd.get(), buffer_.data(), buffer_.size());
  if (!got) return go_down(connection, got.error().what);
  if (got->closed && connection.state == State::securing)
    return go_down(connection, kTlsFailed + std::string("the robot ended the handshake"), kTlsCure);
  if (got->closed) return go_down(connection, "closed by the robot");
  if (got->bytes == 0) return;
  receive(connection, got->bytes);
}

/// A robot's program may say something, close and connect at once: it is the same robot, though its last words are not
/// read yet.
void RobotIo::end_if_left(RobotConnection& connection) {
  if (connection.state != State::up || !tcp_has_ended(connection.fd.get())) return;
  for (int i = 0; i < kMostLastReads && connection.state == State::up; ++i) read(connection);
  if (connection.state == State::up) go_down(connection, "closed by the robot");
  report_losses();
}

void RobotIo::read_datagram(RobotConnection& connection) {
  const auto got = udp_read(connection.fd.get(), buffer_.data(), buffer_.size());
  if (!got) return go_down(connection, got.error().what);
  if (!got->came) return;
  connection.last_failure.clear();
  receive(connection, got->bytes);
}

void RobotIo::receive(RobotConnection& connection, std::size_t size) {
  const BytesView bytes(buffer_.data(), size);
  connection.tls ? receive_encrypted(connection, bytes) : hand_in(connection, bytes);
}

/// What is answered at once is the handshake, or why it ended.
void RobotIo::receive_encrypted(RobotConnection& connection, BytesView bytes) {
  const auto plain = connection.tls->take(bytes);
  connection.output.add(connection.tls->to_send());
  if (!push(connection)) return;
  if (!plain) return go_down(connection, plain.error().what, plain.error().hint);
  const bool ended = connection.tls->ended();
  if (connection.state == State::securing && connection.tls->ready()) come_up(connection);
  if (!plain->empty() && connection.state == State::up) hand_in(connection, *plain);
  if (ended && connection.state == State::up) go_down(connection, "closed by the robot");
}

void RobotIo::hand_in(RobotConnection& connection, BytesView bytes) {
  connection.back_off.reset();
  service_.step([&](Now at, Outbox& out) { core_.on_bytes(connection.channel, bytes, at, out); });
}

/// A connection of datagrams is up as soon as it is dialled, and goes down again if no robot is there.
bool RobotIo::is_new_reason(const RobotConnection& connection, const std::string& reason) {
  return connection.last_failure != reason || (connection.state == State::up && !connection.datagrams);
}

void RobotIo::go_down(RobotConnection& connection, const std::string& reason, const std::string& cure) {
  const bool was_up = connection.state == State::up;
  const bool is_new = is_new_reason(connection, reason);
  close(connection);
  retry_later(connection);
  if (!was_up && !is_new) return;
  connection.last_failure = reason;
  service_.step([&](Now at, Outbox& out) {
    const char* const event = was_up ? "robot_lost" : "robot_not_reached";
    const std::string told = cure.empty() ? reason : reason + "; " + cure;
    if (is_new) out.log(LogLevel::warning, event, std::string(name_of(connection.channel)) + ": " + told);
    core_.on_channel_down(connection.channel, reason, at, out);
  });
}

void RobotIo::close(RobotConnection& connection) {
  if (connection.fd) service_.unwatch(connection.fd.get());
  connection.fd.reset();
  connection.tls.reset();
  connection.state = State::down;
  connection.output.clear();
  connection.has_written = false;
  connection.held_until.reset();
  connection.due.reset();
}

void RobotIo::retry_later(RobotConnection& connection) {
  if (!connection.port) return;
  connection.due = now().mono + connection.back_off.next();
}

void RobotIo::carry_out(const RobotOutbox& out) {
  for (const RobotWrite& order : out.writes) write(connection(order.channel), order.bytes);
  for (const RobotClose& order : out.closes) {
    say_last(connection(order.channel));
    close(connection(order.channel));
    retry_later(connection(order.channel));
  }
}

void RobotIo::write(RobotConnection& connection, BytesView bytes) {
  if (connection.state != State::up) return;
  if (connection.datagrams) {
    if (const Status put = udp_write(connection.fd.get(), bytes); !put) notice_loss(connection, put.error().what);
    return;
  }
  if (connection.output.size() > kMaxWaiting) return notice_loss(connection, "the robot does not read");
  Bytes encrypted;
  if (connection.tls) {
    connection.tls->write(bytes);
    encrypted = connection.tls->to_send();
    bytes = encrypted;
  }
  // The first bytes of a turn are sent at once, the others together at its end: a system call per message would cost
  // more than all the rest of its way.
  if (!std::exchange(connection.has_written, true) && connection.output.empty()) {
    const auto put = tcp_write(connection.fd.get(), bytes);
    if (!put) return notice_loss(connection, put.error().what);
    bytes.remove_prefix(put->bytes);
  }
  connection.output.add(bytes);
}

/// Ends the turn's collecting. False if the connection is lost.
bool RobotIo::push(RobotConnection& connection) {
  connection.has_written = false;
  if (!is_open(connection) || connection.wants_write || connection.output.empty()) return true;
  if (!flush(connection)) return false;
  if (!connection.output.empty()) {
    connection.wants_write = true;
    watch(connection);
  }
  return true;
}

/// What was written leaves, as far as the robot takes it, and with TLS the end of it.
void RobotIo::say_last(RobotConnection& connection) {
  if (connection.tls) {
    connection.tls->end();
    connection.output.add(connection.tls->to_send());
  }
  push(connection);
}

bool RobotIo::flush(RobotConnection& connection) {
  const auto put = tcp_write(connection.fd.get(), connection.output.rest());
  if (!put) {
    notice_loss(connection, put.error().what);
    return false;
  }
  connection.output.written(put->bytes);
  if (!connection.output.empty()) return true;
  if (std::exchange(connection.wants_write, false)) watch(connection);
  return true;
}

void RobotIo::notice_loss(RobotConnection& connection, const std::string& reason) {
  losses_.push_back({connection.channel, reason, is_new_reason(connection, reason)});
  connection.last_failure = reason;
  close(connection);
  retry_later(connection);
}

void RobotIo::report_losses() {
  const std::vector<Notice> losses = std::exchange(losses_, {});
  for (const Notice& loss : losses) {
    service_.step([&](Now at, Outbox& out) {
      if (loss.is_new)
        out.log(LogLevel::warning, "robot_lost", std::string(name_of(loss.channel)) + ": " + loss.reason);
      core_.on_channel_down(loss.channel, loss.reason, at, out);
    });
  }
}

std::optional<MonotonicTime> RobotIo::next_deadline() const {
  const bool has_written = std::any_of(connections_.begin(), connections_.end(),
                                       [](const RobotConnection& connection) { return connection.has_written; });
  if (!losses_.empty() || has_written) return MonotonicTime{};
  std::optional<MonotonicTime> next;
  for (const RobotConnection& connection : connections_) {
    if (connection.held_until && !must_wait(connection)) return MonotonicTime{};
    next = earlier(next, earlier(connection.due, connection.held_until));
  }
  return next;
}

void RobotIo::tick(Now at) {
  for (RobotConnection& written : connections_) push(written);
  report_losses();
  for (RobotConnection& connection : connections_) {
    go_on(connection, at.mono);
    if (!connection.due || at.mono < *connection.due) continue;
    if (connection.state == State::connecting) {
      go_down(connection, "no answer within 2 s");
    } else if (connection.state == State::securing) {
      go_down(connection, kTlsFailed + std::string("the robot did not end the handshake within 5 s"), kTlsCure);
    } else if (connection.state == State::down) {
      dial(connection);
    }
  }
}

}  // namespace trb::adapter
