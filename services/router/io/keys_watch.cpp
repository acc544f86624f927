#include "services/router/io/keys_watch.hpp"

#include <poll.h>
#include <sys/inotify.h>
#include <unistd.h>

namespace trb::router {

KeysWatch::KeysWatch(Loop& loop, const std::string& folder, std::function<void()> on_change)
    : loop_(loop), fd_(::inotify_init1(IN_NONBLOCK | IN_CLOEXEC)) {
  if (!fd_) return;
  ::inotify_add_watch(fd_.get(), folder.c_str(), IN_CLOSE_WRITE | IN_MOVED_TO | IN_ATTRIB | IN_DELETE | IN_MOVED_FROM);
  loop_.add_fd(fd_.get(), POLLIN, [fd = fd_.get(), changed = std::move(on_change)](short) {
    char events[4096];
    while (::read(fd, events, sizeof events) > 0) {
    }
    changed();
  });
}

KeysWatch::~KeysWatch() {
  if (fd_) loop_.remove_fd(fd_.get());
}

}  // namespace trb::router
