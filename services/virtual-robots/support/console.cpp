#include "services/virtual-robots/support/console.hpp"

#include <iterator>

namespace trb::virtual_robots {
namespace {

enum Entry { kEnd, kStdin, kControl, kStdout };

}  // namespace

void Console::announce(std::string_view words) const {
  print_line(words.empty() ? "ready" : "ready " + std::string(words));
  control_.announce();
}

std::vector<pollfd> Console::to_poll(const Fd& end) const {
  return {{end.get(), POLLIN, 0}, {stdin_.fd(), POLLIN, 0}, {control_.fd(), POLLIN, 0}, {stdout_to_poll(), POLLOUT, 0}};
}

bool Console::wait(std::vector<pollfd>& polled, double deadline) {
  ::poll(polled.data(), polled.size(), poll_timeout(wall_seconds(), deadline));
  return polled[kEnd].revents == 0;
}

std::vector<std::string> Console::read(const std::vector<pollfd>& polled) {
  std::vector<std::string> lines;
  if (polled[kStdin].revents != 0) lines = stdin_.read();
  if (polled[kControl].revents == 0) return lines;
  std::vector<std::string> more = control_.read();
  lines.insert(lines.end(), std::make_move_iterator(more.begin()), std::make_move_iterator(more.end()));
  return lines;
}

}  // namespace trb::virtual_robots
