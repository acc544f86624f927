#include "services/virtual-robots/pioneer/virtual_pioneer.hpp"

#include <algorithm>

#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::pioneer {
namespace {

constexpr double kShortestPeriod = 0.005;
constexpr std::size_t kLargestOutput = std::size_t{64} * 1024;
constexpr std::size_t kReadSize = 4096;
constexpr double kLowCharge = 10;  // percent: under the 11.5 V at which a Pioneer begins to complain

}  // namespace

VirtualPioneer::VirtualPioneer(const Settings& settings)
    : speed_(settings.speed),
      // The packets follow the robot's own time, or a client would get too few from a fast robot.
      sip_period_(std::max(kShortestPeriod, Controller::kSipPeriod / std::max(1.0, settings.speed))),
      controller_(settings.start),
      listener_(listen_on({settings.address, settings.port})),
      console_(settings.control) {}

void VirtualPioneer::run(const Fd& end) {
  console_.announce(std::to_string(port_of(listener_)));
  for (;;) {
    std::vector<pollfd> polled = console_.to_poll(end);
    const std::size_t ports = polled.size();
    const int client_events = output_.empty() ? POLLIN : POLLIN | POLLOUT;
    polled.insert(polled.end(), {{listener_.get(), POLLIN, 0}, {client_.get(), static_cast<short>(client_events), 0}});
    if (!Console::wait(polled, next_sip_)) return;
    pass_time();
    for (const std::string& line : console_.read(polled)) take_line(line);
    if (polled[ports + 1].revents != 0) read_client();
    if (polled[ports].revents != 0) accept_one();
    send_sip();
    for (const std::string& line : controller_.take_lines()) print_line(line);
    flush_lines();
  }
}

void VirtualPioneer::pass_time() {
  const double now = wall_seconds();
  // While the process was paused for long, the robot did not drive.
  controller_.advance(std::min(now - last_, 1.0) * speed_, now);
  last_ = now;
}

void VirtualPioneer::send_sip() {
  if (last_ < next_sip_) return;
  next_sip_ = std::max(next_sip_ + sip_period_, last_);
  write(controller_.sip());
}

void VirtualPioneer::accept_one() {
  Fd socket = accept_client(listener_);
  if (!socket) return;
  if (client_) return print_line("client_refused");
  client_ = std::move(socket);
  output_.clear();
  print_line("connected");
}

void VirtualPioneer::read_client() {
  if (!client_) return;
  std::string bytes;
  const Transfer transfer = read_some(client_, bytes, kReadSize);
  const std::string answers = controller_.take(bytes, last_);
  if (transfer.kind == Transfer::Kind::closed) return drop("closed");
  write(answers);
}

void VirtualPioneer::write(std::string_view bytes) {
  if (!client_) return;
  output_ += bytes;
  const Transfer transfer = write_some(client_, output_);
  if (transfer.kind == Transfer::Kind::closed) return drop("closed");
  output_.erase(0, transfer.bytes);
  if (output_.size() > kLargestOutput) drop("does_not_read");
}

void VirtualPioneer::drop(const char* reason) {
  client_.reset();
  output_.clear();
  print_line("disconnected " + std::string(reason));
}

void VirtualPioneer::take_line(const std::string& line) {
  std::string_view rest = line;
  const std::string_view word = take_word(rest);
  if (word == "fault") return fault(rest);
  if (line == "where")
    return print_line(where_line({controller_.place().x, controller_.place().y, controller_.place().heading}));
  if (line == "clear") return controller_.set_fault(Fault::none, "");
  const auto percent = word == "battery" ? parse_number(rest) : std::nullopt;
  if (!percent) return print_line("unknown_line");
  controller_.set_charge(std::clamp(*percent, 0.0, 100.0));
}

/** Each severity is one of a Pioneer's own faults. */
void VirtualPioneer::fault(std::string_view words) {
  const auto order = parse_fault_order(words);
  if (!order) return print_line("unknown_line");
  if (order->severity == "WARNING") return controller_.set_charge(kLowCharge);
  if (order->severity == "URGENT") return controller_.set_fault(Fault::stall, order->text);
  controller_.set_fault(order->severity == "FATAL" ? Fault::stop_button : Fault::motors_off, order->text);
}

}  // namespace trb::virtual_robots::pioneer
