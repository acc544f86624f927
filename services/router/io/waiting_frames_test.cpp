// Whose frames wait for a service, or on a link: what one peer leaves to the others, and what is gone.
#include "services/router/io/waiting_frames.hpp"

#include <doctest/doctest.h>

#include <deque>

#include "services/router/io/shared_queue.hpp"

using namespace trb;
using namespace trb::router;

namespace {

constexpr std::size_t kKilo = 1024;

/// The queue of a service that does not read, as libzmq has it.
struct Queue {
  WaitingFrames waiting{8 * kKilo * kKilo};
  std::deque<Frame> frames;
  bool is_full = false;

  bool send(const std::string& peer, std::size_t size = 60) {
    Frame frame = to_frame(Bytes(size, 'x'));
    if (!waiting.has_room(peer, frame.size())) return false;
    return waiting.send(peer, frame, [&](Frame&& one) {
      if (is_full) return SendResult::full;
      frames.push_back(std::move(one));
      return SendResult::sent;
    }) == SendResult::sent;
  }
  std::size_t fill(const std::string& peer, std::size_t size = 60) {
    std::size_t sent = 0;
    while (sent < 10'000 && send(peer, size)) ++sent;
    return sent;
  }
  void read(std::size_t count) {
    for (std::size_t i = 0; i < count; ++i) frames.pop_front();
  }
};

}  // namespace

TEST_CASE("a peer that floods has half of the queue, the next one half of the rest; whoever comes finds room") {
  Queue queue;
  CHECK(queue.fill("bee") == WaitingFrames::kMost / 2);
  CHECK(queue.fill("cat") == WaitingFrames::kMost / 4);
  CHECK(queue.fill("dog") == WaitingFrames::kMost / 8);
  CHECK_FALSE(queue.send("bee"));
  CHECK(queue.send("ant"));
}

TEST_CASE("what the service has read is room again, known to a few frames") {
  Queue queue;
  const std::size_t sent = queue.fill("bee");
  queue.read(100);
  const std::size_t more = queue.fill("bee");
  CHECK(more <= 100);
  CHECK(more > 100 - WaitingFrames::kEach);
  queue.read(queue.frames.size());
  CHECK(queue.waiting.count() < WaitingFrames::kEach);
  CHECK(queue.fill("bee") > sent - WaitingFrames::kEach);
}

TEST_CASE("bytes are shared alike: pictures of one peer leave room for another's, and for small messages") {
  Queue queue;
  constexpr std::size_t kPicture = 256 * kKilo;
  CHECK(queue.fill("bee", kPicture) == 16);
  CHECK(queue.fill("cat", kPicture) == 8);
  CHECK(queue.send("bee"));
  queue.read(queue.frames.size());
  CHECK(queue.waiting.count() < WaitingFrames::kEach);
  CHECK(queue.fill("bee", kPicture) == 16);
}

TEST_CASE("a frame that was not sent is as it was, and nothing counts as gone") {
  Queue queue;
  const std::size_t sent = queue.fill("bee") - WaitingFrames::kEach;
  queue.read(queue.frames.size() - sent);
  const std::size_t waits = queue.waiting.count();
  queue.is_full = true;
  for (const std::size_t size : {std::size_t{8}, std::size_t{60}, 2 * kKilo}) {
    for (std::size_t i = 0; i < 2 * WaitingFrames::kEach; ++i) {
      Frame frame = to_frame(Bytes(size, 'p'));
      const void* at = frame.data();
      const auto full = [](Frame&&) { return SendResult::full; };
      CHECK(queue.waiting.send("cat", frame, full) == SendResult::full);
      CHECK(frame.data() == at);
      CHECK(view_of(frame) == Bytes(size, 'p'));
    }
  }
  CHECK(queue.waiting.count() == waits);
}

TEST_CASE("frames outlive the queue's count") {
  std::deque<Frame> frames;
  {
    Queue queue;
    queue.fill("bee", 2 * kKilo);
    frames = std::move(queue.frames);
  }
  CHECK(view_of(frames.back()) == Bytes(2 * kKilo, 'x'));
}

TEST_CASE("a peer's name that is gone with its frame is not read any more") {
  Queue queue;
  for (std::size_t i = 0; i < WaitingFrames::kMost / 2; ++i) {
    std::string name = "bee";
    Frame frame = to_frame(Bytes(60, 'x'));
    REQUIRE(queue.waiting.has_room(name, frame.size()));
    queue.waiting.send(name, frame, [&](Frame&& one) {
      queue.frames.push_back(std::move(one));
      name = "cat";
      return SendResult::sent;
    });
  }
  CHECK_FALSE(queue.waiting.has_room("bee", 60));
  CHECK(queue.waiting.has_room("cat", 60));
}

TEST_CASE("on a link that a member has a relay flood there is room for others, and for what the relay says itself") {
  SharedQueue queue(std::make_shared<ByteBudget>(8 * kKilo * kKilo), 4 * kKilo * kKilo, 500);
  std::deque<Frame> frames;
  const auto send = [&](std::string_view peer, std::size_t size) {
    Frame frame = to_frame(Bytes(size, 'x'));
    return queue.send(peer, frame, [&](Frame&& one) {
      if (frames.size() == 1000) return SendResult::full;
      frames.push_back(std::move(one));
      return SendResult::sent;
    });
  };
  const auto flood = [&](std::string_view peer, std::size_t size) {
    std::size_t sent = 0;
    while (send(peer, size) == SendResult::sent) ++sent;
    return sent;
  };
  SUBCASE("with small messages") {
    CHECK(flood("evil", 60) == 250);
    CHECK_FALSE(queue.has_share("evil", 60));
    CHECK(flood("bee", 60) == 125);
    CHECK(flood({}, 60) == 625);
  }
  SUBCASE("with large ones") {
    CHECK(flood("evil", kKilo * kKilo) == 2);
    CHECK_FALSE(queue.has_share("evil", kKilo * kKilo));
    CHECK(queue.has_share("evil", 60));
    CHECK(flood("bee", kKilo * kKilo) == 1);
    CHECK(flood({}, kKilo * kKilo) == 5);
    CHECK_FALSE(queue.has_room(kKilo * kKilo));
  }
  frames.clear();
  CHECK(queue.has_share("evil", 60));
}
