#include "services/virtual-robots/support/control.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <array>

#include "services/virtual-robots/support/process.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots {
namespace {

constexpr std::array<std::string_view, 4> kSeverities = {"WARNING", "URGENT", "CRITICAL", "FATAL"};
constexpr int kMostLines = 16;

Endpoint control_endpoint(std::string_view text) {
  const std::size_t colon = text.rfind(':');
  const std::string_view port = colon == std::string_view::npos ? std::string_view{} : text.substr(colon + 1);
  const bool any_port = port == "auto" || port == "0";
  // Any valid port replaces "auto" while the address is checked.
  auto endpoint = parse_endpoint(any_port ? std::string(text.substr(0, colon)) + ":1" : std::string(text));
  if (!endpoint) throw OptionError("--control needs HOST:PORT, the host as four numbers: " + std::string(text));
  if (any_port) endpoint->port = 0;
  return *endpoint;
}

}  // namespace

ControlPort::ControlPort(const std::optional<Endpoint>& where) {
  if (where) socket_ = bind_datagrams(*where);
}

void ControlPort::announce() const {
  if (socket_) print_line("control " + std::to_string(port_of(socket_)));
}

std::vector<std::string> ControlPort::read() {
  std::vector<std::string> lines;
  // One byte more than is allowed, to detect longer lines.
  std::array<char, kLongestLine + 1> buffer;
  for (int i = 0; i < kMostLines; ++i) {
    const ssize_t size = ::recv(socket_.get(), buffer.data(), buffer.size(), 0);
    if (size < 0) break;
    std::string line(buffer.data(), static_cast<std::size_t>(size));
    if (line.ends_with('\n')) line.pop_back();
    if (line.size() > kLongestLine || line.find('\n') != std::string::npos) line.clear();
    lines.push_back(std::move(line));
  }
  return lines;
}

Option control_option(std::optional<Endpoint>& where) {
  return {"--control", "HOST:PORT|HOST:auto", "the lines of stdin are also taken as datagrams there",
          [&where](std::string_view text) { where = control_endpoint(text); }};
}

std::optional<FaultOrder> parse_fault_order(std::string_view words) {
  FaultOrder order;
  order.capability = take_word(words);
  if (order.capability.empty()) return std::nullopt;
  if (words.empty()) return order;
  order.severity = take_word(words);
  if (std::find(kSeverities.begin(), kSeverities.end(), order.severity) == kSeverities.end()) return std::nullopt;
  order.text = unescape_line(words);
  return order;
}

}  // namespace trb::virtual_robots
