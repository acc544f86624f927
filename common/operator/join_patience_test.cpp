// A node with a code, and a cloud node that does not answer as it should. Time is given, nothing waits.
#include "common/operator/join_patience.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::op;

namespace {

using Kind = DoorAnswer::Kind;

struct Waiting {
  MonotonicTime now{1'000'000'000'000};
  JoinPatience patience{"10.0.0.1:45000", seconds(30), now};
  JoinStage stage = JoinStage::asks;

  Status none(Kind kind, const std::string& text = {}) { return patience.on_none({kind, {}, text}, stage, now); }
  Status offer() { return patience.on_offer(stage, now); }
  void pass(Duration time) { now = now + time; }
  /// For so long each answer is that one; the error, or Done.
  Status answers(Kind kind, const std::string& text, Duration time) {
    for (const MonotonicTime end = now + time; now < end; pass(patience.pause())) {
      if (Status goes_on = none(kind, text); !goes_on) return goes_on;
    }
    return Done{};
  }
};

}  // namespace

TEST_CASE("a code that the cloud node does not know yet, for it has just started again, is tried for some seconds") {
  Waiting node;
  CHECK(node.none(Kind::goodbye, "unknown_peer_key").ok());
  CHECK(node.answers(Kind::refused, "", seconds(8)).ok());
  CHECK(node.patience.pause() > std::chrono::milliseconds(500));
  CHECK(node.offer().ok());
  CHECK(node.patience.pause() < std::chrono::milliseconds(500));
}

TEST_CASE("a code that it goes on not to know is told as that") {
  Waiting node;
  const Status over = node.answers(Kind::refused, "", seconds(17));
  REQUIRE_FALSE(over.ok());
  CHECK(over.error().what.find("does not know this code") != std::string::npos);
}

TEST_CASE("a cloud node that starts again late has its seconds then, too") {
  Waiting node;
  CHECK(node.answers(Kind::refused, "", seconds(8)).ok());
  CHECK(node.answers(Kind::nobody, "", seconds(10)).ok());
  CHECK(node.answers(Kind::refused, "", seconds(8)).ok());
}

TEST_CASE("two nodes that call too often with one code go on, and are told of each other in the end") {
  Waiting node;
  CHECK(node.answers(Kind::goodbye, "queue_full", seconds(25)).ok());
  const Status over = node.answers(Kind::goodbye, "queue_full", seconds(10));
  CHECK(over.error().code == Errc::queue_full);
  CHECK(over.error().what.find("too often") != std::string::npos);
}

TEST_CASE("another reason is told as it is, another version by its name, at once") {
  Waiting node;
  CHECK(node.none(Kind::goodbye, "malformed").error().what.find("malformed") != std::string::npos);
  CHECK(node.none(Kind::goodbye, "version_mismatch: 3 here").error().code == Errc::version_mismatch);
}

TEST_CASE("nobody at the address is waited for as long as it was said; after a good answer for a minute") {
  Waiting node;
  CHECK(node.answers(Kind::nobody, "", seconds(29)).ok());
  CHECK(node.answers(Kind::nobody, "", seconds(3)).error().code == Errc::peer_unreachable);
  Waiting known;
  REQUIRE(known.offer().ok());
  known.stage = JoinStage::invited;
  CHECK(known.answers(Kind::refused, "", seconds(55)).ok());
  CHECK(known.answers(Kind::silent, "", seconds(6)).error().code == Errc::timeout);
}

TEST_CASE(
    "answers that say nothing are waited for two minutes, and so is the inviter; a node that has joined waits for "
    "nobody") {
  Waiting node;
  node.pass(seconds(119));
  CHECK(node.offer().ok());  // rubbish
  node.stage = JoinStage::invited;
  REQUIRE(node.offer().ok());
  node.pass(seconds(119));
  CHECK(node.offer().ok());
  node.pass(seconds(1));
  CHECK(node.offer().error().code == Errc::timeout);
  node.stage = JoinStage::joined;
  CHECK(node.offer().ok());
  CHECK(node.answers(Kind::refused, "", seconds(9)).ok());
  CHECK_FALSE(node.answers(Kind::refused, "", seconds(2)).ok());
}
