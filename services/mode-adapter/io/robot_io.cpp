#include "services/mode-adapter/io/robot_io.hpp"

#include <poll.h>

#include <algorithm>
#include <utility>

#include "services/mode-adapter/io/udp.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kReadSize = 64U << 10U;
/// A robot for which this much waits does not read any more. One message always fits, whatever its size.
constexpr std::size_t kMaxWaiting = 1U << 20U;
constexpr int kAcceptBatch = 16;
constexpr Duration kFirstBackOff = std::chrono::milliseconds(100);
constexpr Duration kLongestBackOff = std::chrono::seconds(2);
constexpr Duration kConnectTimeout = std::chrono::seconds(2);

}  // namespace

Result<std::unique_ptr<RobotIo>> RobotIo::open(const RobotIoSettings& settings, Service& service,
                                               ModeAdapterCore& core) {
  auto listener = tcp_listen(settings.listen_address, settings.listen_port);
  if (!listener) return listener.error();
  return std::unique_ptr<RobotIo>(new RobotIo(settings, service, core, std::move(*listener)));
}

RobotIo::RobotIo(const RobotIoSettings& settings, Service& service, ModeAdapterCore& core, Descriptor listener)
    : settings_(settings), service_(service), core_(core), listener_(std::move(listener)), buffer_(kReadSize, '\0') {
  road(Channel::field).channel = Channel::field;
  road(Channel::command).channel = Channel::command;
  road(Channel::command).port = settings.command_port;
  road(Channel::monitor).channel = Channel::monitor;
  road(Channel::monitor).port = settings.monitor_port;
  for (Road& dialled : roads_) {
    dialled.back_off = kFirstBackOff;
    dialled.datagrams = settings.datagrams && dialled.port;
    if (dialled.port) dialled.due = now().mono;
  }
  service_.watch(listener_.get(), POLLIN, [this](short) { accept_all(); });
  service_.on_robot([this](const Outbox& out) { carry_out(out); });
  service_.timer([this] { return next_deadline(); }, [this](Now at) { tick(at); });
}

RobotIo::~RobotIo() {
  for (Road& open : roads_) close(open);
  service_.unwatch(listener_.get());
}

void RobotIo::accept_all() {
  tell_losses();
  for (int i = 0; i < kAcceptBatch; ++i) {
    Accepted accepted = tcp_accept(listener_.get());
    if (!accepted.fd) return;
    take_in(std::move(accepted));
  }
}

void RobotIo::take_in(Accepted accepted) {
  const bool stranger = !settings_.robot_host.empty() && accepted.peer != settings_.robot_host;
  Road& field = road(Channel::field);
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

void RobotIo::dial(Road& road) {
  if (road.datagrams) return dial_datagrams(road);
  auto dialled = tcp_dial(settings_.robot_host, *road.port);
  if (!dialled) return go_down(road, dialled.error().what);
  road.fd = std::move(*dialled);
  road.state = State::connecting;
  road.due = now().mono + kConnectTimeout;
  service_.watch(road.fd.get(), POLLOUT, [this, &road](short) { on_dialled(road); });
}

/// Nobody answers to that: the road is up, and what the robot says tells whether somebody is there.
void RobotIo::dial_datagrams(Road& road) {
  auto dialled = udp_dial(settings_.robot_host, *road.port);
  if (!dialled) return go_down(road, dialled.error().what);
  road.fd = std::move(*dialled);
  road.state = State::up;
  road.due.reset();
  watch(road);
  service_.step([&](Now at, Outbox& out) { core_.on_channel_up(road.channel, at, out); });
}

void RobotIo::on_dialled(Road& road) {
  if (const Status connected = tcp_connected(road.fd.get()); !connected) return go_down(road, connected.error().what);
  come_up(road);
}

void RobotIo::come_up(Road& road) {
  road.state = State::up;
  road.due.reset();
  road.last_failure.clear();
  road.wants_write = false;
  watch(road);
  service_.step([&](Now at, Outbox& out) {
    out.log(LogLevel::info, "robot_connected", std::string(name_of(road.channel)));
    core_.on_channel_up(road.channel, at, out);
  });
}

void RobotIo::watch(Road& road) {
  const auto events = static_cast<short>(road.wants_write ? POLLIN | POLLOUT : POLLIN);
  service_.watch(road.fd.get(), events, [this, &road](short revents) { on_ready(road, revents); });
}

void RobotIo::on_ready(Road& road, short revents) {
  tell_losses();
  if (road.state != State::up) return;
  if ((revents & POLLOUT) != 0 && !flush(road)) return tell_losses();
  if ((revents & (POLLIN | POLLERR | POLLHUP)) != 0) read(road);
}

void RobotIo::read(Road& road) {
  if (road.datagrams) return read_datagram(road);
  const auto got = tcp_read(road.fd.get(), buffer_.data(), buffer_.size());
  if (!got) return go_down(road, got.error().what);
  if (got->closed) return go_down(road, "closed by the robot");
  if (got->bytes == 0) return;
  hear(road, got->bytes);
}

void RobotIo::read_datagram(Road& road) {
  const auto got = udp_read(road.fd.get(), buffer_.data(), buffer_.size());
  if (!got) return go_down(road, got.error().what);
  if (!got->came) return;
  road.last_failure.clear();
  hear(road, got->bytes);
}

void RobotIo::hear(Road& road, std::size_t size) {
  road.back_off = kFirstBackOff;
  const BytesView bytes(buffer_.data(), size);
  service_.step([&](Now at, Outbox& out) { core_.on_bytes(road.channel, bytes, at, out); });
}

/// A road of datagrams is up as soon as it is dialled, and goes down again if nobody is there.
bool RobotIo::is_news(const Road& road, const std::string& reason) {
  return road.last_failure != reason || (road.state == State::up && !road.datagrams);
}

void RobotIo::go_down(Road& road, const std::string& reason) {
  const bool was_up = road.state == State::up;
  const bool news = is_news(road, reason);
  close(road);
  retry_later(road);
  if (!was_up && !news) return;
  road.last_failure = reason;
  service_.step([&](Now at, Outbox& out) {
    const char* const event = was_up ? "robot_lost" : "robot_not_reached";
    if (news) out.log(LogLevel::warning, event, std::string(name_of(road.channel)) + ": " + reason);
    core_.on_channel_down(road.channel, reason, at, out);
  });
}

void RobotIo::close(Road& road) {
  if (road.fd) service_.unwatch(road.fd.get());
  road.fd.reset();
  road.state = State::down;
  road.output.clear();
  road.written = 0;
  road.has_written = false;
  road.due.reset();
}

void RobotIo::retry_later(Road& road) {
  if (!road.port) return;
  road.due = now().mono + road.back_off;
  road.back_off = std::min(2 * road.back_off, kLongestBackOff);
}

void RobotIo::carry_out(const Outbox& out) {
  for (const RobotWrite& order : out.writes) write(road(order.channel), order.bytes);
  for (const RobotClose& order : out.closes) {
    push(road(order.channel));
    close(road(order.channel));
    retry_later(road(order.channel));
  }
}

void RobotIo::write(Road& road, BytesView bytes) {
  if (road.state != State::up) return;
  if (road.datagrams) {
    if (const Status put = udp_write(road.fd.get(), bytes); !put) notice_loss(road, put.error().what);
    return;
  }
  if (road.output.size() - road.written > kMaxWaiting) return notice_loss(road, "the robot does not read");
  // The first words of a turn go at once, the others together at its end: a system call a message costs more than all
  // the rest of its way.
  if (!std::exchange(road.has_written, true) && road.written == road.output.size()) {
    const auto put = tcp_write(road.fd.get(), bytes);
    if (!put) return notice_loss(road, put.error().what);
    bytes.remove_prefix(put->bytes);
  }
  road.output += bytes;
}

/// Ends the turn's collecting. False if the connection is lost.
bool RobotIo::push(Road& road) {
  road.has_written = false;
  if (road.state != State::up || road.wants_write || road.written == road.output.size()) return true;
  if (!flush(road)) return false;
  if (!road.output.empty()) {
    road.wants_write = true;
    watch(road);
  }
  return true;
}

bool RobotIo::flush(Road& road) {
  const auto put = tcp_write(road.fd.get(), BytesView(road.output).substr(road.written));
  if (!put) {
    notice_loss(road, put.error().what);
    return false;
  }
  road.written += put->bytes;
  if (road.written < road.output.size()) return true;
  road.output.clear();
  road.written = 0;
  if (std::exchange(road.wants_write, false)) watch(road);
  return true;
}

void RobotIo::notice_loss(Road& road, const std::string& reason) {
  losses_.push_back({road.channel, reason, is_news(road, reason)});
  road.last_failure = reason;
  close(road);
  retry_later(road);
}

void RobotIo::tell_losses() {
  const std::vector<Notice> losses = std::exchange(losses_, {});
  for (const Notice& loss : losses) {
    service_.step([&](Now at, Outbox& out) {
      if (loss.news) out.log(LogLevel::warning, "robot_lost", std::string(name_of(loss.channel)) + ": " + loss.reason);
      core_.on_channel_down(loss.channel, loss.reason, at, out);
    });
  }
}

std::optional<MonotonicTime> RobotIo::next_deadline() const {
  const bool has_written = std::any_of(roads_.begin(), roads_.end(), [](const Road& road) { return road.has_written; });
  if (!losses_.empty() || has_written) return MonotonicTime{};
  std::optional<MonotonicTime> next;
  for (const Road& road : roads_) next = earlier(next, road.due);
  return next;
}

void RobotIo::tick(Now at) {
  for (Road& written : roads_) push(written);
  tell_losses();
  for (Road& road : roads_) {
    if (!road.due || at.mono < *road.due) continue;
    if (road.state == State::connecting) {
      go_down(road, "no answer within 2 s");
    } else if (road.state == State::down) {
      dial(road);
    }
  }
}

}  // namespace trb::adapter
