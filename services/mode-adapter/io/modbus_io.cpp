#include "services/mode-adapter/io/modbus_io.hpp"

#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <utility>

#include "common/base/back_off.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kMaxPacket = 4096;
constexpr Duration kFirstBackOff = std::chrono::milliseconds(100);
constexpr Duration kSteady = std::chrono::seconds(2);  ///< longer than a round of polls
constexpr Duration kLongestBackOff = std::chrono::seconds(2);

// A packet: its kind, the number of its connection, and its contents.
enum class Kind : char { call = 'c', up = 'u', answer = 'a', down = 'd' };
constexpr std::size_t kHead = 1 + sizeof(std::uint32_t);

Bytes packet_of(Kind kind, std::uint32_t connection, BytesView rest) {
  Bytes out(kHead, static_cast<char>(kind));
  std::memcpy(out.data() + 1, &connection, sizeof connection);
  return out.append(rest);
}

std::uint32_t connection_of(BytesView packet) {
  std::uint32_t connection = 0;
  std::memcpy(&connection, packet.data() + 1, sizeof connection);
  return connection;
}

/// The thread: connects, makes one call after the other, and reconnects when the connection is lost.
class Worker {
 public:
  Worker(ModbusLink::Where where, Descriptor socket) : link_(std::move(where)), socket_(std::move(socket)) {}

  void run() {
    while (!ended_) {
      ++connection_;
      const Status connected = link_.connect();
      if (connected) serve();
      if (!connected) put(Kind::down, connected.error().what);
      link_.close();
      pause();
    }
  }

 private:
  void serve() {
    put(Kind::up, {});
    const MonotonicTime begun = now().mono;
    while (const auto call = next_call(-1)) {
      const auto answer = link_.perform(*call);
      if (!answer) return put(Kind::down, answer.error().what);
      put(Kind::answer, encode(*answer));
      // One that hangs at some call of each round has answered others before.
      if (now().mono - begun >= kSteady) back_off_.reset();
    }
  }

  /// Waits before the next dial; calls that come meanwhile belong to a connection that is gone.
  void pause() {
    const MonotonicTime end = now().mono + back_off_.next();
    while (!ended_) {
      const auto left = std::chrono::ceil<std::chrono::milliseconds>(end - now().mono).count();
      if (left <= 0) return;
      next_call(static_cast<int>(left));
    }
  }

  /// None: the time is over, or the process ends.
  std::optional<ModbusCall> next_call(int wait_ms) {
    while (!ended_) {
      pollfd entry{socket_.get(), POLLIN, 0};
      const int found = ::poll(&entry, 1, wait_ms);
      if (found == 0) return std::nullopt;
      if (found < 0) continue;  // EINTR
      std::array<char, kMaxPacket> buffer{};
      const ssize_t size = ::recv(socket_.get(), buffer.data(), buffer.size(), 0);
      ended_ = size <= 0;
      const BytesView packet(buffer.data(), static_cast<std::size_t>(std::max<ssize_t>(size, 0)));
      if (packet.size() <= kHead || connection_of(packet) != connection_) continue;
      if (const auto call = decode_modbus_call(packet.substr(kHead))) return call;
    }
    return std::nullopt;
  }

  void put(Kind kind, BytesView rest) {
    const Bytes packet = packet_of(kind, connection_, rest);
    if (::send(socket_.get(), packet.data(), packet.size(), MSG_NOSIGNAL) < 0) ended_ = true;
  }

  ModbusLink link_;
  Descriptor socket_;
  std::uint32_t connection_ = 0;
  BackOff back_off_{kFirstBackOff, kLongestBackOff};
  bool ended_ = false;
};

}  // namespace

Result<std::unique_ptr<ModbusIo>> ModbusIo::open(ModbusLink::Where where, Service& service, ModeAdapterCore& core) {
  std::array<int, 2> pair{};
  if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, pair.data()) != 0) {
    return fail(Errc::io_error, std::string("socketpair: ") + std::strerror(errno));
  }
  return std::unique_ptr<ModbusIo>(
      new ModbusIo(std::move(where), service, core, Descriptor(pair[0]), Descriptor(pair[1])));
}

ModbusIo::ModbusIo(ModbusLink::Where where, Service& service, ModeAdapterCore& core, Descriptor ours, Descriptor theirs)
    : service_(service), core_(core), ours_(std::move(ours)) {
  service_.watch(ours_.get(), POLLIN, [this](short) { on_packets(); });
  // Service::open has blocked the signals for this thread too: the loop takes them.
  thread_ = std::thread([worker = std::make_shared<Worker>(std::move(where), std::move(theirs))] { worker->run(); });
}

ModbusIo::~ModbusIo() {
  service_.unwatch(ours_.get());
  ours_.reset();
  thread_.join();
}

void ModbusIo::carry_out(const RobotOutbox& out) {
  for (const RobotWrite& order : out.writes) {
    if (order.channel == Channel::command) write(order.bytes);
  }
}

void ModbusIo::write(BytesView call) {
  if (connection_ == 0) return;
  const Bytes packet = packet_of(Kind::call, connection_, call);
  // One call at a time: the pair has room for it.
  ::send(ours_.get(), packet.data(), packet.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
}

void ModbusIo::on_packets() {
  std::array<char, kMaxPacket> buffer{};
  for (;;) {
    const ssize_t size = ::recv(ours_.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    if (size < static_cast<ssize_t>(kHead)) return;
    on_packet(BytesView(buffer.data(), static_cast<std::size_t>(size)));
  }
}

void ModbusIo::on_packet(BytesView packet) {
  const auto kind = static_cast<Kind>(packet.front());
  const BytesView rest = packet.substr(kHead);
  if (kind == Kind::up) {
    connection_ = connection_of(packet);
    answered_ = false;
    return service_.step([&](Now at, Outbox& out) { core_.on_channel_up(Channel::command, at, out); });
  }
  if (kind == Kind::answer) {
    service_.step([&](Now at, Outbox& out) {
      if (!std::exchange(answered_, true)) out.log(LogLevel::info, "robot_connected", "modbus");
      core_.on_bytes(Channel::command, rest, at, out);
    });
    return last_failure_.clear();
  }
  connection_ = 0;
  const std::string reason(rest);
  const bool is_new = answered_ || reason != last_failure_;
  last_failure_ = reason;
  service_.step([&](Now at, Outbox& out) {
    if (is_new) out.log(LogLevel::warning, answered_ ? "robot_lost" : "robot_not_reached", "modbus: " + reason);
    core_.on_channel_down(Channel::command, reason, at, out);
  });
  answered_ = false;
}

}  // namespace trb::adapter
