#include "services/router/io/keys_watch.hpp"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

namespace trb::router {

KeysWatch::KeysWatch(Loop& loop, const std::string& folder, std::function<void()> on_change)
    : loop_(loop), fd_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  if (fd_ < 0) return;
  ::inotify_add_watch(fd_, folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO);
  loop_.add_fd(fd_, POLLIN, [fd = fd_, changed = std::move(on_change)](short) {
    char events[4096];
    while (::read(fd, events, sizeof events) > 0) {
    }
    changed();
  });
}

KeysWatch::~KeysWatch() {
  if (fd_ < 0) return;
  loop_.remove_fd(fd_);
  ::close(fd_);
}

}  // namespace trb::router
