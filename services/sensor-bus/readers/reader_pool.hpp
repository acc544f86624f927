// What readers' threads and the loop share: one box for what was read, and how many threads there are.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <variant>
#include <vector>

#include "common/base/descriptor.hpp"
#include "services/sensor-bus/core/device_events.hpp"

namespace trb::sensor {

/// What a thread has read, and whose it is: a reader's number is never used again.
struct Post {
  std::uint64_t reader = 0;
  std::variant<Sample, Picture> what;
};

class ReaderPool {
 public:
  /// Errors: io_error.
  static Result<std::shared_ptr<ReaderPool>> make();
  explicit ReaderPool(Descriptor ready) : ready_(std::move(ready)) {}

  /// From any thread. A box that nobody empties holds kMaxPosts; what comes then is dropped and counted.
  void post(Post post);
  /// On the loop's thread, when ready_fd() is readable.
  std::vector<Post> take();
  [[nodiscard]] int ready_fd() const { return ready_.get(); }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_; }

  std::atomic<std::size_t> threads{0};  ///< those that hang and were left behind too

 private:
  static constexpr std::size_t kMaxPosts = 16'384;

  Descriptor ready_;
  std::mutex mutex_;
  std::vector<Post> posts_;
  std::atomic<std::uint64_t> dropped_{0};
};

}  // namespace trb::sensor
