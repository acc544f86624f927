// The messages that a KUKA's program sends, by themselves.
#include "common/drivers/c3/messages.hpp"

#include "common/drivers/c3/test/parts.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

struct MessagesBench : C3Bench {
  C3Messages messages{*read_c3_names({}, true), "kuka"};

  void chunk(const std::string& subtype, const std::string& target, int size, const std::string& data) {
    messages.on_raised(link, now, out);
    for (const std::string& part : {std::string("\"information\""), '"' + subtype + '"', '"' + target + '"',
                                    std::to_string(size), '"' + data + '"'}) {
      messages.on_part(answer(part).reply);
    }
    answer("");
    messages.on_cleared(out);
  }
};

}  // namespace

TEST_CASE("chunks make one message of the size that was told; without a target it is the node's own") {
  MessagesBench bench;
  bench.chunk("greeting", "ur3", 8, "half");
  CHECK(bench.told<Said>().empty());
  bench.chunk("greeting", "ur3", 8, "half");
  const auto said = bench.told<Said>();
  REQUIRE(said.size() == 1);
  CHECK(said[0].target == "ur3");
  CHECK(said[0].data == "halfhalf");
  bench.chunk("greeting", "", 2, "me");
  CHECK(bench.told<Said>().at(0).target == "kuka");
}

TEST_CASE("too much data, no word, no id, or a word of the middleware's: refused and counted") {
  MessagesBench bench;
  bench.chunk("greeting", "ur3", 1, "long");
  bench.chunk("two words", "ur3", 0, "");
  bench.chunk("greeting", "no id!", 0, "");
  bench.chunk("stop", "ur3", 0, "");
  CHECK(bench.told<Said>().empty());
  CHECK(bench.outbox.counts == std::vector<std::string>{"refused.bad_message", "refused.bad_message",
                                                        "refused.bad_message", "refused.typed_subtype"});
}

TEST_CASE("a new connection forgets the chunks of the old one") {
  MessagesBench bench;
  bench.chunk("greeting", "ur3", 8, "half");
  bench.messages.restart();
  bench.chunk("greeting", "ur3", 4, "full");
  CHECK(bench.told<Said>().at(0).data == "full");
}
