#include "services/sensor-bus/readers/reader_context.hpp"

#include <sys/eventfd.h>

#include <array>
#include <cerrno>
#include <cstring>

#include "common/service/service.hpp"

namespace trb::sensor {
Error system_error(const std::string& what, int number) {
  // strerror is not for threads.
  std::array<char, 128> words{};
  return fail(Errc::io_error, what + ": " + ::strerror_r(number, words.data(), words.size()),
              number == EACCES ? "let the user of trb-sensor-bus read it" : "look at the device and its cable");
}

void ReaderOrders::ask(std::size_t channel) {
  {
    const std::lock_guard lock(mutex);
    asked.insert(channel);
  }
  ::eventfd_write(wake.get(), 1);
}

void ReaderOrders::end() {
  stop = true;
  ::eventfd_write(wake.get(), 1);
}

ReaderContext::ReaderContext(FoundDevice found, std::shared_ptr<ReaderOrders> orders, std::shared_ptr<ReaderPool> pool)
    : found_(std::move(found)), orders_(std::move(orders)), reader_pool_(std::move(pool)) {}

ReaderContext::Woken ReaderContext::wait(int fd, std::optional<MonotonicTime> deadline) {
  for (;;) {
    if (stopped()) return Woken::stopped;
    std::int64_t wait_ms = -1;
    if (deadline) wait_ms = std::max<std::int64_t>(0, (*deadline - now().mono).count() / 1'000'000 + 1);
    std::array<pollfd, 2> entries{pollfd{orders_->wake.get(), POLLIN, 0}, pollfd{fd, POLLIN, 0}};
    const int found =
        ::poll(entries.data(), fd < 0 ? 1 : 2, static_cast<int>(std::min<std::int64_t>(wait_ms, 3'600'000)));
    if (found < 0) continue;  // EINTR
    if (stopped()) return Woken::stopped;
    if (entries[0].revents != 0) {
      eventfd_t ignored = 0;
      ::eventfd_read(orders_->wake.get(), &ignored);
      return Woken::asked;
    }
    if (fd >= 0 && entries[1].revents != 0) return Woken::ready;
    if (deadline && now().mono >= *deadline) return Woken::late;
  }
}

std::set<std::size_t> ReaderContext::take_asked() {
  const std::lock_guard lock(orders_->mutex);
  return std::exchange(orders_->asked, {});
}

void ReaderContext::send(std::size_t channel, const Measured& measured) {
  const FoundChannel& of = channels()[channel];
  const Now at = now();
  Sample sample;
  sample.key = of.plugged.key;
  sample.is_text = measured.is_text;
  sample.number = measured.number * of.how->scale + of.how->offset;
  sample.text = measured.text;
  sample.time = at.utc;
  sample.measured = at.mono;
  reader_pool_->post({orders_->number, std::move(sample)});
}

void ReaderContext::fail_one(std::size_t channel, const Error& error) {
  const Now at = now();
  Sample sample;
  sample.key = channels()[channel].plugged.key;
  sample.time = at.utc;
  sample.measured = at.mono;
  sample.error = error;
  reader_pool_->post({orders_->number, std::move(sample)});
}

void ReaderContext::fail_all(const Error& error) {
  for (std::size_t i = 0; i < channels().size(); ++i) fail_one(i, error);
}

void ReaderContext::show(Picture picture) {
  picture.key = channels().front().plugged.key;
  picture.time = now().utc;
  reader_pool_->post({orders_->number, std::move(picture)});
}

ReaderContext::Busy::Busy(ReaderContext& context) : orders_(*context.orders_) {
  orders_.busy_since = now().mono.ns;
}

}  // namespace trb::sensor
