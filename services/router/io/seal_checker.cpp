#include "services/router/io/seal_checker.hpp"

#include <sys/eventfd.h>
#include <sys/resource.h>

#include <stdexcept>
#include <utility>

#include "common/security/seal.hpp"
#include "services/router/io/worker_thread.hpp"

namespace trb::router {
namespace {

constexpr std::size_t kMaxQueuedRanges = 64;
/// Lower priority than the threads that carry messages, where they share a core.
constexpr int kNice = 5;

}  // namespace

SealChecker::SealChecker() : fd_(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (!fd_) throw std::runtime_error("eventfd failed");
  thread_ = start_without_signals([this] { run(); });
}

SealChecker::~SealChecker() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

bool SealChecker::put(CheckSeal&& seal) {
  {
    const std::lock_guard lock(mutex_);
    if (queue_.size() >= kMaxQueuedRanges) return false;
    queue_.push_back(std::move(seal));
  }
  wake_.notify_one();
  return true;
}

std::vector<SealChecker::Checked> SealChecker::take() {
  eventfd_t count = 0;
  (void)::eventfd_read(fd_.get(), &count);
  const std::lock_guard lock(mutex_);
  return std::exchange(checked_, {});
}

void SealChecker::run() {
  (void)::setpriority(PRIO_PROCESS, static_cast<id_t>(::gettid()), kNice);
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return ending_ || !queue_.empty(); });
    if (ending_) return;
    CheckSeal seal = std::move(queue_.front());
    queue_.pop_front();
    lock.unlock();
    const bool good = verify_seal(seal.record, *seal.signer);
    lock.lock();
    checked_.push_back({std::move(seal), good});
    // An earlier result was already signalled.
    if (checked_.size() == 1) (void)::eventfd_write(fd_.get(), 1);
  }
}

}  // namespace trb::router
