// What a reader of devices is told and tells; it runs on a thread of its own, which may hang.
#pragma once

#include <poll.h>

#include <memory>
#include <set>

#include "services/sensor-bus/core/recognition.hpp"
#include "services/sensor-bus/readers/measured.hpp"
#include "services/sensor-bus/readers/reader_pool.hpp"

namespace trb::sensor {

/// What the loop tells the thread. Both hold it: a thread that hangs outlives its device.
struct ReaderOrders {
  std::uint64_t number = 0;
  Descriptor wake;  ///< an eventfd
  std::atomic<bool> stop{false};
  std::atomic<bool> ended{false};           ///< the thread is gone
  std::atomic<std::int64_t> busy_since{0};  ///< monotonic ns: it is in a call that may hang; 0: it is not
  std::mutex mutex;
  std::set<std::size_t> asked;  ///< channels to be read, or photographed, at once

  void ask(std::size_t channel);
  void end();
};

/// The thread's side: what a kind of reader needs.
class ReaderContext {
 public:
  ReaderContext(FoundDevice found, std::shared_ptr<ReaderOrders> orders, std::shared_ptr<ReaderPool> pool);

  [[nodiscard]] const Device& device() const { return found_.device; }
  [[nodiscard]] const SensorRule& rule() const { return *found_.rule; }
  [[nodiscard]] const std::vector<FoundChannel>& channels() const { return found_.channels; }
  [[nodiscard]] bool stopped() const { return orders_->stop; }

  enum class Woken { stopped, asked, ready, late };
  /// Waits for `fd` (or -1), an order or the deadline.
  Woken wait(int fd, std::optional<MonotonicTime> deadline);
  /// The channels that were asked for since the last call.
  std::set<std::size_t> take_asked();

  void send(std::size_t channel, const Measured& measured);
  void fail_one(std::size_t channel, const Error& error);
  void fail_all(const Error& error);
  void show(Picture picture);

  /// While it lives the thread is in a call that may hang.
  class Busy {
   public:
    explicit Busy(ReaderContext& context);
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;
    ~Busy() { orders_.busy_since = 0; }

   private:
    ReaderOrders& orders_;
  };

 private:
  FoundDevice found_;
  std::shared_ptr<ReaderOrders> orders_;
  std::shared_ptr<ReaderPool> reader_pool_;
};

/// "WHAT: the system's words"
Error system_error(const std::string& what, int number);

}  // namespace trb::sensor
