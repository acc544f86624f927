// What a Universal Robot's controller sends on its monitor connection: the packets, and the direct mode behind them.
#define DOCTEST_CONFIG_DISABLE  // the fixture is for doctest; here require() tells
#include <cmath>

#include "common/drivers/tcp-text/ur_monitor.hpp"
#include "common/drivers/tcp-text/ur_rtde.hpp"
#include "services/mode-adapter/test/fixture.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::adapter;

/// The same number of events, whether the bytes come at once or one by one; nothing is read twice.
void check_cutting(BytesView input) {
  UrMonitor whole;
  UrMonitor pieces;
  std::vector<UrEvent> at_once;
  std::vector<UrEvent> one_by_one;
  const Status read = whole.add(input, at_once);
  Status last = Done{};
  for (std::size_t i = 0; i < input.size() && last; ++i) last = pieces.add(input.substr(i, 1), one_by_one);
  require(read.ok() == last.ok(), "where the stream breaks does not depend on how it is cut");
  require(at_once.size() == one_by_one.size(), "what is heard does not depend on how it is cut");
}

/// The same of the real-time data exchange.
void check_rtde(BytesView input) {
  UrRtde whole(10);
  UrRtde pieces(10);
  Bytes said = whole.begin();
  Bytes said_too = pieces.begin();
  std::vector<UrSample> at_once;
  std::vector<UrSample> one_by_one;
  const Status read = whole.add(input, at_once, said);
  Status last = Done{};
  for (std::size_t i = 0; i < input.size() && last; ++i) last = pieces.add(input.substr(i, 1), one_by_one, said_too);
  require(read.ok() == last.ok(), "where RTDE breaks does not depend on how it is cut");
  require(at_once.size() == one_by_one.size() && said == said_too, "RTDE does not depend on how it is cut");
}

/// A skill that runs while the controller sends this: it is answered, and the reports to the fleet are bounded.
void check_mode(BytesView input) {
  UrFixture fixture;
  fixture.deliver(MessageType::command, order("reach", R"({"joints": [0,0,0,0,0,0]})"), "ur3");
  fixture.monitor(ur_started("trb_77_1"));
  fixture.monitor(Bytes(input));
  for (const Send& send : fixture.out.sends) {
    if (const auto* fault = get_if<RobotFault>(&send.body)) {
      require(is_utf8(fault->text) && fault->text.size() <= 1024, "a fault's text is short and UTF-8");
    }
  }
  fixture.wait(30);
  require(!fixture.told<Outcome>().empty(), "the skill has an outcome");
}

}  // namespace

std::vector<Bytes> seeds() {
  return {ur_state(),
          ur_state({.running = true, .protective = true}) + ur_state({.emergency = true, .mode = 3}),
          ur_started("trb_77_1") + ur_text("trb_77_1 done") + ur_stopped("trb_77_1"),
          ur_exception(2, 9, "compile_error_name_not_found:moovej:") + ur_stopped("trb_77_1"),
          ur_message(6, big_endian(153, 4) + big_endian(0, 4) + big_endian(3, 4) + Bytes(8, '\0') + "deviates"),
          ur_message(3, "version"),
          Bytes("\0\4V\1", 4) + Bytes("\0\x15O\1VECTOR6D,VECTOR6D", 21) + Bytes("\0\4S\1", 4) + Bytes("\0\x64U\1", 4) +
              Bytes(96, '\0'),
          big_endian(5, 4) + "\x10"};
}

void run(BytesView input) {
  check_cutting(input);
  check_rtde(input);
  check_mode(input);
}

}  // namespace trb::fuzz
