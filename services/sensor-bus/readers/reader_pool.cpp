#include "services/sensor-bus/readers/reader_pool.hpp"

#include <sys/eventfd.h>

#include <cerrno>
#include <cstring>

namespace trb::sensor {

Result<std::shared_ptr<ReaderPool>> ReaderPool::make() {
  Descriptor ready(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!ready) return fail(Errc::io_error, std::string("eventfd: ") + std::strerror(errno));
  return std::make_shared<ReaderPool>(std::move(ready));
}

void ReaderPool::post(Post post) {
  bool first = false;
  {
    const std::lock_guard lock(mutex_);
    if (posts_.size() >= kMaxPosts) {
      ++dropped_;
      return;
    }
    first = posts_.empty();
    posts_.push_back(std::move(post));
  }
  if (first) ::eventfd_write(ready_.get(), 1);
}

std::vector<Post> ReaderPool::take() {
  eventfd_t ignored = 0;
  ::eventfd_read(ready_.get(), &ignored);
  const std::lock_guard lock(mutex_);
  return std::exchange(posts_, {});
}

}  // namespace trb::sensor
