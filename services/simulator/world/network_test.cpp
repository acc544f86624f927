// A connection that is cut and healed: what waited arrives, in the order in which it was sent.
#include "services/simulator/world/network.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::world;

namespace {

using std::chrono::milliseconds;

class Computer final : public Host {
 public:
  explicit Computer(Bytes key) : key_(std::move(key)) {}
  [[nodiscard]] const Bytes& link_key() const override { return key_; }
  bool admit(BytesView) override { return true; }
  void on_dial_connected(LinkId) override { is_connected = true; }
  void on_dial_ended(LinkId, LinkEndReason) override {}
  void on_frame(LinkId, BytesView, Bytes frame) override { heard.push_back(frame); }
  void on_connection_end(LinkId) override { heard.emplace_back("end"); }
  void on_beacon(BytesView) override {}

  bool is_connected = false;
  std::vector<std::string> heard;

 private:
  Bytes key_;
};

/// r0 has dialled r1; one way takes 10 ms.
class Two {
 public:
  explicit Two(std::uint64_t bytes_a_second = LinkKind{}.bytes_a_second)
      : network_(events_, meter_, dice_, kind_of(bytes_a_second)) {
    network_.join("r0", "r0:1", r0);
    network_.join("r1", "r1:1", r1);
    network_.dial("r0", {kLink, "r1:1", r1.link_key()});
    pass(1000);
    REQUIRE(r0.is_connected);
  }
  void pass(int ms) {
    const MonotonicTime limit = events_.now() + milliseconds(ms);
    while (events_.step(limit)) {
    }
  }
  void send(const std::string& frame) { CHECK(network_.send(kLink, "r0", "", frame)); }
  void close() { network_.close(kLink, "r0"); }
  /// r1's processes end, and others begin at once.
  void restart_r1() {
    network_.leave("r1");
    network_.join("r1", "r1:1", r1);
  }
  void cut() {
    network_.cut("r0", "r1");
    network_.cut("r1", "r0");
  }
  void heal_there() { network_.heal("r0", "r1"); }
  void heal() {
    heal_there();
    network_.heal("r1", "r0");
  }
  /// The link is cut for 20 ms: "a" is sent at its beginning, "b" 5 ms before its end.
  void send_two_while_cut() {
    cut();
    send("a");
    pass(15);
    send("b");
    pass(5);
    heal();
  }

 private:
  static constexpr LinkId kLink = 7;
  static LinkKind kind_of(std::uint64_t bytes_a_second) {
    LinkKind out;
    out.delay = milliseconds(10);
    out.deviation = {};
    out.loss = 0;
    out.bytes_a_second = bytes_a_second;
    return out;
  }

  Events events_;
  Meter meter_{60};
  Dice dice_{1};
  world::Network network_;

 public:
  Computer r0{"key of r0"};
  Computer r1{"key of r1"};
};

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("what waited for a link to be healed arrives before what was under way then") {
  Two two;
  two.send_two_while_cut();
  two.send("c");
  two.close();
  two.pass(9);
  CHECK(two.r1.heard.empty());
  two.pass(1000);
  CHECK(two.r1.heard == Texts{"a", "b", "c", "end"});
}

TEST_CASE("a link that is cut again before anything has arrived holds all of it back") {
  Two two;
  two.send_two_while_cut();
  two.pass(2);
  two.cut();
  two.send("c");
  two.pass(1000);
  CHECK(two.r1.heard.empty());
  two.heal();
  two.pass(9);
  CHECK(two.r1.heard.empty());
  two.pass(2);
  CHECK(two.r1.heard == Texts{"a", "b", "c"});
}

TEST_CASE("what waited needs a slow link's time once, and what is sent then comes behind it") {
  Two two(1000);
  two.cut();
  // With what the wire adds each has 100 bytes.
  for (const char letter : {'a', 'b', 'c', 'd', 'e'}) two.send(std::string(65, letter));
  two.pass(1000);
  two.heal();
  two.send(std::string(65, 'f'));
  two.pass(509);
  CHECK(two.r1.heard.empty());
  two.pass(1);
  CHECK(two.r1.heard.size() == 5);
  two.pass(100);
  CHECK(two.r1.heard.size() == 6);
}

TEST_CASE("what was sent to processes that have ended reaches none that come after them") {
  Two two;
  two.send("under way");
  two.pass(5);
  two.restart_r1();
  two.send("sent before r0 has heard of it");
  two.pass(1000);
  CHECK(two.r1.heard.empty());
  CHECK(two.r0.heard == Texts{"end"});
}

TEST_CASE("what waited for a healed link to processes that have ended is lost with them") {
  Two two;
  two.send_two_while_cut();
  two.cut();
  two.pass(1000);
  two.restart_r1();
  two.heal_there();
  two.pass(1000);
  CHECK(two.r1.heard.empty());
}
