#include "services/virtual-robots/drone/virtual_drone.hpp"

#include <arpa/inet.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::drone {
namespace {

constexpr double kNavdataPeriod = 1.0 / 15;
constexpr int kMostDatagrams = 64;

std::uint16_t navdata_port(const std::optional<std::uint16_t>& port) {
  return port ? static_cast<std::uint16_t>(*port - 2) : std::uint16_t{0};
}

}  // namespace

VirtualDrone::VirtualDrone(const Settings& settings)
    : commands_(bind_datagrams({settings.address, settings.port.value_or(0)})),
      navdata_(bind_datagrams({settings.address, navdata_port(settings.port)})),
      console_(settings.control),
      controller_(settings.speed, wall_seconds()) {
  controller_.set_battery(settings.battery);
}

void VirtualDrone::run(const Fd& end) {
  console_.announce(std::to_string(port_of(commands_)) + " " + std::to_string(port_of(navdata_)));
  for (;;) {
    std::vector<pollfd> polled = console_.to_poll(end);
    const std::size_t ports = polled.size();
    polled.insert(polled.end(), {{commands_.get(), POLLIN, 0}, {navdata_.get(), POLLIN, 0}});
    if (!Console::wait(polled, next_navdata_)) return;
    if (polled[ports].revents != 0) read_commands();
    if (polled[ports + 1].revents != 0) read_wake_ups();
    for (const std::string& line : console_.read(polled)) take_line(line);
    flush_lines();
    send_navdata();
    tell_events();
  }
}

void VirtualDrone::read_commands() {
  // One byte more than is allowed, to detect longer datagrams.
  std::array<char, kLongestDatagram + 1> buffer;
  for (int i = 0; i < kMostDatagrams; ++i) {
    const ssize_t size = ::recv(commands_.get(), buffer.data(), buffer.size(), 0);
    if (size < 0) return;
    controller_.take({buffer.data(), static_cast<std::size_t>(size)}, wall_seconds());
  }
}

/** A client that sends anything here gets navdata from now on; one at a time, the last one. */
void VirtualDrone::read_wake_ups() {
  std::array<char, 64> buffer;
  for (int i = 0; i < kMostDatagrams; ++i) {
    sockaddr_in from{};
    socklen_t length = sizeof from;
    const ssize_t size =
        ::recvfrom(navdata_.get(), buffer.data(), buffer.size(), 0, reinterpret_cast<sockaddr*>(&from), &length);
    // An error may concern a former client's closed port: another datagram may follow.
    if (size < 0 && (errno == EAGAIN || errno == EWOULDBLOCK)) return;
    if (size < 0) continue;
    const bool other =
        !client_ || client_->sin_addr.s_addr != from.sin_addr.s_addr || client_->sin_port != from.sin_port;
    client_ = from;
    controller_.wake(other);
    if (!other) continue;
    std::array<char, INET_ADDRSTRLEN> text{};
    ::inet_ntop(AF_INET, &from.sin_addr, text.data(), text.size());
    print_line("client " + std::string(text.data()) + ":" + std::to_string(ntohs(from.sin_port)));
  }
}

void VirtualDrone::take_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  const auto fault = order == "fault" ? parse_fault_order(words) : std::nullopt;
  const auto percent = order == "battery" ? parse_number(words) : std::nullopt;
  if (fault) {
    take_fault(*fault);
  } else if (percent && *percent >= 0 && *percent <= 100) {
    controller_.set_battery(*percent);
  } else if (line == "where") {
    controller_.advance(wall_seconds());
    const Aircraft& at = controller_.aircraft();
    print_line(where_line({at.x(), at.y(), at.altitude(), at.heading()}));
  } else if (line == "clear") {
    controller_.clear_faults();
    print_line("cleared");
  } else {
    print_line("unknown_line");
  }
}

/** The drone has bits and no texts: WARNING is wind, URGENT a tilt too far, all else cuts the motors. */
void VirtualDrone::take_fault(const FaultOrder& order) {
  print_line("fault " + order.severity + " " + escape_line(order.text));
  if (order.severity == "WARNING") return controller_.raise(bits::kTooMuchWind);
  if (order.severity == "URGENT") return controller_.raise(bits::kAnglesOutOfRange);
  controller_.fail_emergency();
}

void VirtualDrone::send_navdata() {
  const double now = wall_seconds();
  if (now < next_navdata_) return;
  // After a long pause of the process the missed packets are not sent all at once.
  next_navdata_ = std::max(next_navdata_ + kNavdataPeriod, now);
  controller_.advance(now);
  if (!client_ || !controller_.tells()) return;
  const std::string packet = controller_.navdata();
  ::sendto(navdata_.get(), packet.data(), packet.size(), MSG_NOSIGNAL | MSG_DONTWAIT,
           reinterpret_cast<const sockaddr*>(&*client_), sizeof *client_);
}

void VirtualDrone::tell_events() {
  for (const std::string& event : controller_.take_events()) print_line(event);
}

}  // namespace trb::virtual_robots::drone
