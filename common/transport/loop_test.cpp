#include "common/transport/loop.hpp"

#include <poll.h>
#include <unistd.h>

#include <doctest/doctest.h>
#include <algorithm>
#include <array>
#include <memory>
#include <thread>
#include <utility>
#include <vector>

#include "common/transport/socket.hpp"

using namespace trb;

namespace {

constexpr Duration kPatience = std::chrono::seconds(8);  // less than a turn takes that waits for nothing

/// A bus of two sockets in memory: the server knows the client, and neither has anything to read.
struct Bus {
  Context context;
  Socket server;
  Socket client;
  Bytes client_id;

  Bus()
      : server(std::move(*Socket::bus_server(context, "inproc://bus"))),
        client(Socket::bus_client(context, "inproc://bus")) {
    client.send(to_frame("hello"));
    Frame frame;
    while (!server.receive(frame)) std::this_thread::yield();
    client_id = view_of(frame);
    while (server.receive(frame)) {
    }
  }
  bool takes_one() {
    Frame frame;
    return client.receive(frame);
  }
};

/// What the socket's descriptor signals, without touching the socket.
bool can_be_read(Socket& socket) {
  int fd = -1;
  std::size_t size = sizeof fd;
  REQUIRE(zmq_getsockopt(socket.handle(), ZMQ_FD, &fd, &size) == 0);
  pollfd asked{fd, POLLIN, 0};
  return ::poll(&asked, 1, 0) == 1;
}

/// Turns until it is true; the loop gets a deadline, so that a message that it overlooks shows as late.
template <class F>
bool soon(Loop& loop, const F& condition) {
  const MonotonicTime end = read_clocks().mono + kPatience;
  loop.add_timer([end] { return std::optional(end); }, [](Now) {});
  while (!condition() && read_clocks().mono < end) loop.turn();
  return condition() && read_clocks().mono < end;
}

/// A message for the client waits that its descriptor does not signal.
void swallow_signal(Bus& bus) {
  CHECK(bus.server.send_to(bus.client_id, to_frame("message")) == SendResult::sent);
  while (can_be_read(bus.client)) bus.client.send(to_frame("something else"));
}

/// One turn that does not wait.
void turn_at_once(Loop& loop) {
  const auto due = std::make_shared<bool>(true);
  loop.add_timer([due] { return *due ? std::optional(MonotonicTime{}) : std::nullopt; }, [due](Now) { *due = false; });
  loop.turn();
}

}  // namespace

TEST_CASE("a message is heard whose signal a send has swallowed") {
  Bus bus;
  Loop loop;
  int heard = 0;
  const auto drain = [&] {
    while (bus.takes_one()) ++heard;
  };
  loop.add_socket(bus.client.handle(), drain, bus.client.unseen());
  turn_at_once(loop);
  CHECK(bus.server.send_to(bus.client_id, to_frame("message")) == SendResult::sent);
  // A send processes the socket's mailbox only now and then, and then the descriptor is silent.
  REQUIRE(can_be_read(bus.client));
  while (can_be_read(bus.client)) bus.client.send(to_frame("something else"));
  CHECK(soon(loop, [&] { return heard == 1; }));
}

TEST_CASE("a handler that takes one message a call gets them all") {
  Bus bus;
  Loop loop;
  int heard = 0;
  const auto take_one = [&] { heard += bus.takes_one() ? 1 : 0; };
  SUBCASE("the socket tells of what it has not shown") {
    loop.add_socket(bus.client.handle(), take_one, bus.client.unseen());
  }
  SUBCASE("the loop keeps count itself") {
    loop.add_socket(bus.client.handle(), take_one);
  }
  for (int i = 0; i < 10; ++i) bus.server.send_to(bus.client_id, to_frame("message"));
  CHECK(soon(loop, [&] { return heard == 10; }));
}

TEST_CASE("a message is heard whose signal another socket's handler has swallowed, whichever comes first in a turn") {
  std::array<Bus, 2> busses;
  Loop loop;
  std::array<int, 2> heard{};
  for (std::size_t i = 0; i < 2; ++i) {
    loop.add_socket(
        busses[i].client.handle(),
        [&, i] {
          for (; busses[i].takes_one(); ++heard[i]) {
            if (heard[1 - i] == 0) swallow_signal(busses[1 - i]);
          }
        },
        busses[i].client.unseen());
  }
  turn_at_once(loop);
  std::size_t first = 0;
  SUBCASE("one way") {}
  SUBCASE("the other way") {
    first = 1;
  }
  busses[first].server.send_to(busses[first].client_id, to_frame("message"));
  CHECK(soon(loop, [&] { return heard[first] >= 1 && heard[1 - first] == 1; }));
}

TEST_CASE("a handler that turns the loop itself hears a socket that waits in the outer turn, its signal swallowed") {
  std::array<Bus, 2> busses;
  Loop loop;
  std::array<int, 2> heard{};
  bool is_within = false;
  for (std::size_t i = 0; i < 2; ++i) {
    loop.add_socket(
        busses[i].client.handle(),
        [&, i] {
          while (busses[i].takes_one()) ++heard[i];
          if (std::exchange(is_within, true)) return;
          swallow_signal(busses[1 - i]);
          CHECK(soon(loop, [&] { return heard[1 - i] == 2; }));
        },
        busses[i].client.unseen());
  }
  turn_at_once(loop);
  for (auto& bus : busses) bus.server.send_to(bus.client_id, to_frame("message"));
  CHECK(soon(loop, [&] { return heard[0] + heard[1] == 3; }));
}

TEST_CASE("a handler may close a socket that is ready too, and itself") {
  std::array<std::unique_ptr<Bus>, 3> busses;
  for (auto& bus : busses) bus = std::make_unique<Bus>();
  Loop loop;
  int calls = 0;
  for (std::size_t i = 0; i < busses.size(); ++i) {
    loop.add_socket(
        busses[i]->client.handle(),
        [&, i] {
          ++calls;
          // All but one, which is called next and closes itself, whichever was called first.
          for (std::size_t j = 0; j < busses.size(); ++j) {
            if (j == (i + 1) % busses.size() || busses[j] == nullptr) continue;
            loop.remove_socket(busses[j]->client.handle());
            busses[j].reset();
          }
        },
        busses[i]->client.unseen());
    busses[i]->server.send_to(busses[i]->client_id, to_frame("message"));
  }
  for (int i = 0; i < 3; ++i) turn_at_once(loop);
  CHECK(calls == 2);
  for (const auto& bus : busses) CHECK(bus == nullptr);
}

TEST_CASE("what a handler adds is served from the next turn on") {
  Bus first;
  Bus second;
  Loop loop;
  int heard = 0;
  const auto hear = [&] { heard += second.takes_one() ? 1 : 0; };
  second.server.send_to(second.client_id, to_frame("message"));
  loop.add_socket(
      first.client.handle(),
      [&] {
        if (first.takes_one()) loop.add_socket(second.client.handle(), hear, second.client.unseen());
      },
      first.client.unseen());
  first.server.send_to(first.client_id, to_frame("message"));
  loop.turn();
  CHECK(heard == 0);
  CHECK(soon(loop, [&] { return heard == 1; }));
}

TEST_CASE("of many sockets each hears its message once, and an idle one is not called") {
  constexpr std::size_t kMany = 200;  // more than one wait reports
  std::vector<std::unique_ptr<Bus>> busses;
  std::vector<int> heard(kMany);
  std::vector<int> calls(kMany);
  Loop loop;
  for (std::size_t i = 0; i < kMany; ++i) {
    Bus& bus = *busses.emplace_back(std::make_unique<Bus>());
    loop.add_socket(
        bus.client.handle(),
        [&, i] {
          ++calls[i];
          for (; busses[i]->takes_one(); ++heard[i]) {
          }
        },
        bus.client.unseen());
  }
  for (int i = 0; i < 8; ++i) turn_at_once(loop);  // what connecting has left
  calls.assign(kMany, 0);
  for (std::size_t i = 0; i < kMany; i += 2) busses[i]->server.send_to(busses[i]->client_id, to_frame("message"));
  const auto all_heard = [&] { return std::ranges::count(heard, 1) == kMany / 2; };
  CHECK(soon(loop, all_heard));
  for (std::size_t i = 1; i < kMany; i += 2) CHECK(calls[i] == 0);
}

TEST_CASE("a socket outlives its loop, and is served by the next one") {
  Bus bus;
  int heard = 0;
  const auto drain = [&] {
    while (bus.takes_one()) ++heard;
  };
  {
    Loop loop;
    loop.add_socket(bus.client.handle(), drain, bus.client.unseen());
    turn_at_once(loop);
  }
  swallow_signal(bus);
  Loop next;
  next.add_socket(bus.client.handle(), drain, bus.client.unseen());
  CHECK(soon(next, [&] { return heard == 1; }));
}

TEST_CASE("what may wait is called once a turn, each in its turn, and nothing of it is lost") {
  std::array<Bus, 3> busses;
  Loop loop;
  std::array<int, 3> heard{};
  int calls = 0;
  for (std::size_t i = 0; i < busses.size(); ++i) {
    const auto take_one = [&, i] {
      ++calls;
      heard[i] += busses[i].takes_one() ? 1 : 0;
    };
    loop.add_background_socket(busses[i].client.handle(), take_one, busses[i].client.unseen());
  }
  for (Bus& bus : busses) {
    for (int i = 0; i < 4; ++i) bus.server.send_to(bus.client_id, to_frame("message"));
  }
  for (int turn = 1; turn <= 6; ++turn) {
    loop.turn();
    CHECK(calls == turn);
  }
  CHECK(heard == std::array<int, 3>{2, 2, 2});
  CHECK(soon(loop, [&] { return heard == std::array<int, 3>{4, 4, 4}; }));
}

TEST_CASE("of many more that may wait than one wait reports each is called in its turn, behind what may not wait") {
  constexpr std::size_t kMany = 200;
  constexpr int kRounds = 3;
  std::vector<std::unique_ptr<Bus>> busses;
  std::vector<int> calls(kMany);
  Loop loop;
  for (std::size_t i = 0; i < kMany; ++i) {
    Bus& bus = *busses.emplace_back(std::make_unique<Bus>());
    const auto take_one = [&, i] {
      if (busses[i]->takes_one()) ++calls[i];
    };
    loop.add_background_socket(bus.client.handle(), take_one, bus.client.unseen());
  }
  for (std::size_t i = 0; i < kMany; ++i) turn_at_once(loop);  // what connecting has left
  Bus urgent;
  int heard = 0;
  const auto hear = [&] { heard += urgent.takes_one() ? 1 : 0; };
  loop.add_socket(urgent.client.handle(), hear, urgent.client.unseen());
  turn_at_once(loop);
  for (auto& bus : busses) {
    for (int i = 0; i <= kRounds; ++i) bus->server.send_to(bus->client_id, to_frame("message"));
  }
  urgent.server.send_to(urgent.client_id, to_frame("message"));
  loop.turn();
  CHECK(heard == 1);
  for (int round = 1; round <= kRounds; ++round) {
    const std::size_t turns = round == 1 ? kMany - 1 : kMany;
    for (std::size_t i = 0; i < turns; ++i) loop.turn();
    CHECK(std::ranges::count(calls, round) == kMany);
  }
}

TEST_CASE("one that may wait and comes to nothing costs the others no turn") {
  std::array<Bus, 3> busses;
  Loop loop;
  std::array<int, 3> heard{};
  for (std::size_t i = 0; i < busses.size(); ++i) {
    const auto take_one = [&, i] { heard[i] += busses[i].takes_one() ? 1 : 0; };
    loop.add_background_socket(busses[i].client.handle(), take_one, busses[i].client.unseen());
  }
  for (std::size_t i = 0; i < busses.size(); ++i) turn_at_once(loop);
  busses[0].client.send(to_frame("something else"));
  busses[1].server.send_to(busses[1].client_id, to_frame("message"));
  busses[2].client.send(to_frame("something else"));
  loop.turn();
  CHECK(heard == std::array<int, 3>{0, 1, 0});
}

TEST_CASE("one that may wait and is removed, or removes itself, is not called again; added anew it is") {
  std::array<Bus, 2> busses;
  Loop loop;
  std::array<int, 2> calls{};
  const auto add = [&](std::size_t i) {
    loop.add_background_socket(
        busses[i].client.handle(),
        [&, i] {
          ++calls[i];
          for (Bus& bus : busses) loop.remove_socket(bus.client.handle());
        },
        busses[i].client.unseen());
  };
  for (std::size_t i = 0; i < busses.size(); ++i) {
    busses[i].server.send_to(busses[i].client_id, to_frame("message"));
    add(i);
  }
  for (int i = 0; i < 3; ++i) turn_at_once(loop);
  CHECK(calls == std::array<int, 2>{1, 0});
  add(1);
  CHECK(soon(loop, [&] { return calls[1] == 1; }));
}

TEST_CASE("descriptors are served beside sockets, and none that was removed") {
  Bus bus;
  Loop loop;
  std::array<int, 2> pipe{};
  REQUIRE(::pipe(pipe.data()) == 0);
  int calls = 0;
  loop.add_socket(
      bus.client.handle(), [] {}, bus.client.unseen());
  loop.add_fd(pipe[0], POLLIN, [&](short events) {
    CHECK((events & POLLIN) != 0);
    ++calls;
    loop.remove_fd(pipe[0]);
  });
  REQUIRE(::write(pipe[1], "x", 1) == 1);
  CHECK(soon(loop, [&] { return calls == 1; }));
  turn_at_once(loop);
  CHECK(calls == 1);
  ::close(pipe[0]);
  ::close(pipe[1]);
}

TEST_CASE("a program with an event loop of its own drives this one by a descriptor and a deadline") {
  Bus bus;
  Loop loop;
  int heard = 0;
  bool ticked = false;
  const auto take_one = [&] {
    Frame frame;
    if (bus.client.receive(frame)) ++heard;
  };
  loop.add_socket(bus.client.handle(), take_one, bus.client.unseen());
  MonotonicTime due = read_clocks().mono + std::chrono::hours(1);
  loop.add_timer([&] { return ticked ? std::nullopt : std::optional(due); }, [&](Now) { ticked = true; });
  // If nothing is ready, the timer's deadline is all there is to wait for, and nothing is called before it.
  CHECK(loop.handle_ready());
  CHECK(loop.next_deadline() == due);
  CHECK(heard == 0);
  CHECK_FALSE(ticked);
  due = read_clocks().mono + std::chrono::milliseconds(30);
  // When messages arrive, the descriptor signals them; for those left after the first, the deadline does.
  for (int i = 0; i < 3; ++i) bus.server.send_to(bus.client_id, to_frame("message"));
  const MonotonicTime end = read_clocks().mono + kPatience;
  while ((heard < 3 || !ticked) && read_clocks().mono < end) {
    const auto next = loop.next_deadline();
    const Duration left = next ? std::max(Duration::zero(), *next - read_clocks().mono) : kPatience;
    pollfd item{loop.descriptor(), POLLIN, 0};
    ::poll(&item, 1, static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count()));
    CHECK(loop.handle_ready());
  }
  CHECK(heard == 3);
  CHECK(ticked);
  CHECK(read_clocks().mono < end);
  CHECK_FALSE(loop.next_deadline());
  loop.stop();
  CHECK_FALSE(loop.handle_ready());
}
