// A loop of ours in an io_context, driven as the gateway's process does.
#include "services/cloud-gateway/io/loop_bridge.hpp"

#include <doctest/doctest.h>
#include <poll.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <boost/asio/executor_work_guard.hpp>

#include "common/base/descriptor.hpp"
#include "common/transport/loop.hpp"

using namespace trb;
using namespace trb::gateway;

namespace {

constexpr Duration kPatience = std::chrono::seconds(8);

struct Bridged {
  Loop loop;
  boost::asio::io_context io;
  LoopBridge bridge{
      io, {loop.descriptor(), [this] { return loop.next_deadline(); }, [this] { return loop.handle_ready(); }}};
  boost::asio::executor_work_guard<boost::asio::io_context::executor_type> work = boost::asio::make_work_guard(io);

  /// Only events and deadlines wake it.
  template <class Condition>
  bool until(Condition condition) {
    const MonotonicTime end = read_clocks().mono + kPatience;
    for (MonotonicTime now = read_clocks().mono; now < end; now = read_clocks().mono) {
      if (!bridge.serve(now)) return false;
      if (condition()) return true;
      const MonotonicTime due = std::min(end, bridge.next_deadline().value_or(end));
      io.run_one_for(std::max(Duration::zero(), due - read_clocks().mono));
    }
    return false;
  }
};

struct Pipe {
  Pipe() {
    std::array<int, 2> ends{};
    REQUIRE(::pipe(ends.data()) == 0);
    read_end = Descriptor(ends[0]);
    write_end = Descriptor(ends[1]);
  }
  Descriptor read_end;
  Descriptor write_end;
};

}  // namespace

TEST_CASE("what a handler leaves in its descriptor is heard at once, without a deadline") {
  const Pipe pipe;
  Bridged bridged;
  int heard = 0;
  bridged.loop.add_fd(pipe.read_end.get(), POLLIN, [&](short) {
    char byte = 0;
    if (::read(pipe.read_end.get(), &byte, 1) == 1) ++heard;
  });
  REQUIRE(::write(pipe.write_end.get(), "a", 1) == 1);
  REQUIRE(bridged.until([&] { return heard == 1; }));
  REQUIRE(::write(pipe.write_end.get(), "bcd", 3) == 3);
  CHECK(bridged.until([&] { return heard == 4; }));
}

TEST_CASE("a deadline of the driven loop is kept, and its end is told") {
  Bridged bridged;
  std::optional<MonotonicTime> due = read_clocks().mono + std::chrono::milliseconds(20);
  bool is_over = false;
  bridged.loop.add_timer([&] { return due; },
                         [&](Now) {
                           due.reset();
                           is_over = true;
                         });
  CHECK(bridged.until([&] { return is_over; }));
  bridged.loop.stop();
  due = MonotonicTime{};
  CHECK_FALSE(bridged.bridge.serve(read_clocks().mono));
}
