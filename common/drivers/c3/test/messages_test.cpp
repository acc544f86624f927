// The messages that a KUKA's program sends, by themselves.
#include "common/drivers/c3/messages.hpp"

#include "common/drivers/c3/test/parts.hpp"

using namespace trb;
using namespace trb::drivers;

namespace {

struct MessagesFixture : PartsFixture {
  C3Messages messages{*read_c3_names({}, true), "kuka"};

  void chunk(const std::string& subtype, const std::string& target, int size, const std::string& data) {
    chunk(subtype, target, std::to_string(size), data);
  }
  void chunk(const std::string& subtype, const std::string& target, const std::string& size, const std::string& data) {
    messages.on_raised(link, now, out);
    for (const std::string& part :
         {std::string("\"information\""), '"' + subtype + '"', '"' + target + '"', size, '"' + data + '"'}) {
      messages.on_part(answer(part).reply);
    }
    answer("");
    messages.on_cleared(out);
  }
};

}  // namespace

TEST_CASE("chunks make one message of the size that was told; without a target it is the node's own") {
  MessagesFixture fixture;
  fixture.chunk("greeting", "ur3", 8, "half");
  CHECK(fixture.told<Said>().empty());
  fixture.chunk("greeting", "ur3", 8, "half");
  const auto said = fixture.told<Said>();
  REQUIRE(said.size() == 1);
  CHECK(said[0].target == "ur3");
  CHECK(said[0].data == "halfhalf");
  fixture.chunk("greeting", "", 2, "me");
  CHECK(fixture.told<Said>().at(0).target == "kuka");
}

TEST_CASE("too much data, no word, no id, or a word of the middleware's: refused and counted") {
  MessagesFixture fixture;
  fixture.chunk("greeting", "ur3", 1, "long");
  fixture.chunk("two words", "ur3", 0, "");
  fixture.chunk("greeting", "no id!", 0, "");
  fixture.chunk("stop", "ur3", 0, "");
  CHECK(fixture.told<Said>().empty());
  CHECK(fixture.outbox.counts == std::vector<std::string>{"refused.bad_message", "refused.bad_message",
                                                          "refused.bad_message", "refused.typed_subtype"});
}

TEST_CASE("a size that no message has is refused at once, and the next message is whole") {
  MessagesFixture fixture;
  for (const char* size : {"1E30", "16777217"}) fixture.chunk("greeting", "ur3", std::string(size), "long");
  CHECK(fixture.outbox.counts == std::vector<std::string>(2, "refused.message_too_long"));
  fixture.chunk("greeting", "ur3", 4, "next");
  CHECK(fixture.told<Said>().at(0).data == "next");
}

TEST_CASE("a new connection forgets the chunks of the old one") {
  MessagesFixture fixture;
  fixture.chunk("greeting", "ur3", 8, "half");
  fixture.messages.restart();
  fixture.chunk("greeting", "ur3", 4, "full");
  CHECK(fixture.told<Said>().at(0).data == "full");
}
