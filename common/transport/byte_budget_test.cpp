// Bytes that wait: counted until they are sent, refused when there is no room, shared fairly, and given back whatever
// happens to the connection.
#include "common/transport/byte_budget.hpp"

#include <doctest/doctest.h>

#include <thread>
#include <vector>

#include "common/transport/loop.hpp"

using namespace trb;

namespace {

constexpr Duration kPatience = std::chrono::seconds(60);
constexpr std::size_t kKilo = 1024;
constexpr std::size_t kMega = 1024 * kKilo;
/// Pictures that a client which does not read has room for: its queue, the kernel's, and the four of the budget. A slow
/// sender fills all of it: the client's thread keeps up with it until the queue is full.
constexpr std::size_t kMostBuffered = kReceiveHighWaterMark + 16;

std::shared_ptr<ByteBudget> budget(std::size_t most, std::shared_ptr<ByteBudget> whole = nullptr) {
  return std::make_shared<ByteBudget>(most, std::move(whole));
}

bool becomes(const ByteBudget& one, std::size_t used) {
  const auto until = read_clocks().mono + kPatience;
  while (one.used() != used && read_clocks().mono < until) std::this_thread::yield();
  return one.used() == used;
}

/// A server and a client that does not read, over ipc.
struct Pair {
  Context context;
  std::string endpoint;
  Socket server;
  Socket client;

  Pair() : Pair("@trb-budget-" + std::to_string(read_clocks().mono.ns)) {}
  explicit Pair(const std::string& name)
      : endpoint("ipc://" + name),
        server(*Socket::bus_server(context, endpoint)),
        client(Socket::bus_client(context, endpoint)) {}

  /// The client's routing id, once it has sent something.
  Bytes hello() {
    Frame id;
    Frame word;
    const auto until = read_clocks().mono + kPatience;
    while (client.send(to_frame("hello")) != SendResult::sent && read_clocks().mono < until) std::this_thread::yield();
    while (!server.receive(id) && read_clocks().mono < until) std::this_thread::yield();
    REQUIRE(server.receive(word));
    return Bytes(view_of(id));
  }
  SendResult send(const Bytes& id, const std::shared_ptr<ByteBudget>& within, Frame& frame) {
    return send_within(within, frame, [&](Frame&& one) { return server.send_to(id, std::move(one)); });
  }
};

}  // namespace

TEST_CASE("a destination takes its own, and no more") {
  const auto one = budget(10);
  CHECK(one->take(6));
  CHECK_FALSE(one->has_room(5));
  CHECK_FALSE(one->take(5));
  CHECK(one->has_room(4));
  CHECK(one->take(4));
  CHECK_FALSE(one->take(1));
  one->give_back(6);
  CHECK(one->used() == 4);
  CHECK(one->take(6));
}

TEST_CASE("many greedy destinations leave room for one that has taken nothing") {
  const auto whole = budget(64 * kMega);
  std::vector<std::shared_ptr<ByteBudget>> greedy;
  for (int i = 0; i < 40; ++i) greedy.push_back(budget(8 * kMega, whole));
  for (bool any = true; any;) {
    any = false;
    for (const auto& one : greedy) any = one->take(64 * kKilo) || any;
  }
  CHECK(whole->used() <= 64 * kMega);
  const auto quiet = budget(8 * kMega, whole);
  CHECK(quiet->take(kMega));
  // Latecomers got as much as the first ones.
  CHECK(greedy.front()->used() <= greedy.back()->used() + 64 * kKilo);
}

TEST_CASE("what one destination refuses is not taken from the whole") {
  const auto whole = budget(100);
  const auto one = budget(10, whole);
  CHECK_FALSE(one->take(11));
  CHECK(whole->used() == 0);
  CHECK(one->take(10));
  CHECK(whole->used() == 10);
  one->give_back(10);
  CHECK(whole->used() == 0);
}

TEST_CASE("a counted frame has the same bytes at the same place, and gives them back once") {
  const auto one = budget(kMega);
  Frame frame(Bytes(5000, 'x').data(), 5000);
  const void* data = frame.data();
  REQUIRE(one->take(5000));
  Frame counted = count_frame(one, std::move(frame));
  CHECK(counted.data() == data);
  CHECK(counted.size() == 5000);
  Frame copy;
  copy.copy(counted);  // as a publisher's subscribers share one
  counted.rebuild();
  CHECK(one->used() == 5000);
  copy.rebuild();
  CHECK(one->used() == 0);
}

TEST_CASE("who does not read gets as many bytes as its budget has, small words still, and all is given back") {
  Pair pair;
  const Bytes id = pair.hello();
  const auto whole = budget(64 * kMega);
  const auto within = budget(4 * kMega, whole);
  const Bytes picture(kMega, 'p');
  SendResult result = SendResult::sent;
  std::size_t sent = 0;
  Frame frame;
  for (; sent < kMostBuffered && result == SendResult::sent; ++sent) {
    frame = to_frame(picture);
    result = pair.send(id, within, frame);
  }
  CHECK(result == SendResult::full);
  CHECK(within->used() <= 4 * kMega);
  // A refused message can still be read: its sender gets a Nack.
  CHECK((view_of(frame) == picture));  // a megabyte is not worth printing
  frame = to_frame("stop");
  CHECK(pair.send(id, within, frame) == SendResult::sent);
  Frame heard;
  std::size_t pictures = 0;
  const auto until = read_clocks().mono + kPatience;
  while (view_of(heard) != "stop" && read_clocks().mono < until) {
    if (pair.client.receive(heard)) pictures += heard.size() == kMega ? 1 : 0;
  }
  CHECK(view_of(heard) == "stop");
  CHECK(pictures == sent - 1);
  CHECK(becomes(*within, 0));
  CHECK(becomes(*whole, 0));
}

TEST_CASE("a connection that goes gives back what waited for it") {
  const auto within = budget(4 * kMega);
  {
    Pair pair;
    const Bytes id = pair.hello();
    // What the client's libzmq still takes in is given back at once: more is sent until its queue is full, too.
    bool waits = false;
    for (const auto until = read_clocks().mono + kPatience; !waits && read_clocks().mono < until;) {
      Frame frame = to_frame(Bytes(kMega, 'p'));
      waits = pair.send(id, within, frame) == SendResult::full && within->used() > 0;
    }
    CHECK(waits);
  }
  CHECK(becomes(*within, 0));
}

TEST_CASE("a frame that finds nobody counts no longer than it lives") {
  Pair pair;
  const auto within = budget(4 * kMega);
  {
    Frame frame = to_frame(Bytes(kMega, 'p'));
    CHECK(pair.send("nobody", within, frame) == SendResult::unroutable);
    CHECK(view_of(frame).size() == kMega);
  }
  CHECK(within->used() == 0);
}
