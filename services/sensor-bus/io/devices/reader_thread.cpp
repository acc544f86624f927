#include "services/sensor-bus/io/devices/reader_thread.hpp"

#include <pthread.h>
#include <sys/eventfd.h>

#include <cerrno>

#include "services/sensor-bus/readers/registry.hpp"

namespace trb::sensor {
namespace {

constexpr std::size_t kStack = 512U * 1024U;  // a pattern's depth is bounded, see LinePattern

struct Start {
  ReaderContext context;
  ReadBy by;
  std::shared_ptr<ReaderOrders> orders;
  std::shared_ptr<ReaderPool> pool;
};

void* thread_main(void* argument) {
  const std::unique_ptr<Start> start(static_cast<Start*>(argument));
  run_reader(start->by, start->context);
  start->orders->ended = true;
  --start->pool->threads;
  return nullptr;
}

int start_detached(Start* start) {
  pthread_attr_t attributes;
  ::pthread_attr_init(&attributes);
  ::pthread_attr_setstacksize(&attributes, kStack);
  ::pthread_attr_setdetachstate(&attributes, PTHREAD_CREATE_DETACHED);
  pthread_t thread{};
  const int problem = ::pthread_create(&thread, &attributes, thread_main, start);
  ::pthread_attr_destroy(&attributes);
  return problem;
}

}  // namespace

Result<std::shared_ptr<ReaderOrders>> start_reader(const FoundDevice& found, std::uint64_t number,
                                                   const std::shared_ptr<ReaderPool>& pool) {
  if (pool->threads >= kMaxReaders) {
    return fail(Errc::queue_full, "there are " + std::to_string(kMaxReaders) + " readers, which is the most",
                "unplug devices, or leave out rules for some");
  }
  auto orders = std::make_shared<ReaderOrders>();
  orders->number = number;
  orders->wake = Descriptor(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!orders->wake) return system_error("eventfd", errno);
  auto start = std::make_unique<Start>(Start{ReaderContext(found, orders, pool), found.rule->by, orders, pool});
  ++pool->threads;
  if (const int problem = start_detached(start.get()); problem != 0) {
    --pool->threads;
    return system_error("a reader's thread", problem);
  }
  start.release();  // NOLINT(bugprone-unused-return-value): the thread's now
  return orders;
}

}  // namespace trb::sensor
