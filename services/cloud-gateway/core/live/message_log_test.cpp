// What has passed the router: newest first, filtered, in pages, and bounded.
#include "services/cloud-gateway/core/live/message_log.hpp"

#include <doctest/doctest.h>

using namespace trb;
using namespace trb::gateway;

namespace {

struct FilledLog {
  MessageLog log;
  std::uint64_t add(const std::string& subtype, const std::string& source, const std::string& target,
                    const Bytes& data = {}, MessageType type = MessageType::information) {
    Message message;
    message.type = type;
    message.subtype = subtype;
    message.source = source;
    message.target = target;
    message.data = data;
    return log.add('>', {1}, to_view(message)).number;
  }
  [[nodiscard]] std::vector<std::uint64_t> numbers(const MessageQuery& query = {}) const {
    std::vector<std::uint64_t> out;
    for (const PassedMessage* one : log.find(query).messages) out.push_back(one->number);
    return out;
  }
};

using Numbers = std::vector<std::uint64_t>;

}  // namespace

TEST_CASE("the newest message comes first; keep-alives are shown on request alone") {
  FilledLog log;
  log.add("move", "cloud", "ur3", "[1]", MessageType::command);
  log.add("keep_alive", "ur3", "cloud");
  log.add("robot_state", "ur3", "*");
  CHECK(log.numbers() == Numbers{3, 1});
  CHECK(log.numbers({.phase = CostPhase::upkeep}) == Numbers{2});
  CHECK(log.numbers({.subtype = "keep_alive"}) == Numbers{2});
}

TEST_CASE("filters: a node as source or target, a subtype, a type, a phase") {
  FilledLog log;
  log.add("move", "cloud", "ur3", "[1]", MessageType::command);
  log.add("move", "cloud", "drone", "[1]", MessageType::command);
  log.add("ready", "ur3", "cloud");
  CHECK(log.numbers({.node = "ur3"}) == Numbers{3, 1});
  CHECK(log.numbers({.subtype = "move"}) == Numbers{2, 1});
  CHECK(log.numbers({.node = "ur3", .type = MessageType::command}) == Numbers{1});
  CHECK(log.numbers({.phase = CostPhase::task}) == Numbers{3, 2, 1});
  CHECK(log.numbers({.phase = CostPhase::sensor}) == Numbers{});
}

TEST_CASE("pages follow each other without gap or repeat while more arrives") {
  FilledLog log;
  for (int i = 0; i < 5; ++i) log.add("move", "cloud", "ur3");
  const auto first = log.log.find({.most = 2});
  CHECK(first.next == 4);
  log.add("move", "cloud", "ur3");
  const auto second = log.log.find({.before = first.next, .most = 2});
  REQUIRE(second.messages.size() == 2);
  CHECK(second.messages[0]->number == 3);
  const auto last = log.log.find({.before = second.next, .most = 2});
  CHECK(last.messages.size() == 1);
  CHECK(last.next == 0);
}

TEST_CASE("each phase of Equation 12 is counted, also what is no longer kept") {
  FilledLog log;
  for (std::size_t i = 0; i < MessageLog::kMaxMessages + 10; ++i) log.add("move", "cloud", "ur3");
  for (int i = 0; i < 3; ++i) log.add("keep_alive", "ur3", "cloud");
  CHECK(log.log.counts()[static_cast<std::size_t>(CostPhase::task)] == MessageLog::kMaxMessages + 10);
  CHECK(log.log.counts()[static_cast<std::size_t>(CostPhase::upkeep)] == 3);
  CHECK(log.numbers({.most = 10'000}).size() == MessageLog::kMaxMessages);
  CHECK(log.numbers({.most = 10'000}).back() == 11);
}

TEST_CASE("a picture is not kept, and large messages push out the oldest") {
  FilledLog log;
  const std::uint64_t picture = log.add("picture", "drone", "cloud", Bytes(MessageLog::kMaxData + 1, 'x'));
  const PassedMessage* kept = log.log.find({}).messages.at(0);
  CHECK(kept->number == picture);
  CHECK(kept->is_cut());
  CHECK(kept->size == MessageLog::kMaxData + 1);
  for (std::size_t i = 0; i < 400; ++i) log.add("scan", "drone", "cloud", Bytes(MessageLog::kMaxData, 'x'));
  CHECK(log.numbers({.most = 10'000}).size() < 256);
}
