#include "services/simulator/job/seen.hpp"

#include <doctest/doctest.h>

#include "services/simulator/counting/play.hpp"
#include "services/simulator/job/job.hpp"

using namespace trb;
using namespace trb::simulator;

namespace {

Value seen_of(const std::string& text) {
  ConfigFaults faults;
  const Job job = read_job(text, faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  Seen seen;
  if (job.world) {
    world::World world(*job.world);
    seen.watch(world);
    world.play();
  } else {
    counting::play(job.plan, [&](const counting::CountedMessage& message) { seen.on_message(message); });
  }
  Value::Object out;
  seen.add_to(out);
  return Value{std::move(out)};
}

/// "KIND NODE" of each, in order.
std::vector<std::string> told(const Value& seen) {
  std::vector<std::string> out;
  for (const Value& one : seen.find("happenings")->list()) {
    const Value* node = one.find("node");
    out.push_back(one.find("kind")->text() + (node == nullptr ? "" : " " + node->text()));
  }
  return out;
}

bool is_sent(const Value& seen, const std::string& phase, const std::string& from, const std::string& to) {
  for (const Value& one : seen.find("sendings")->list()) {
    if (one.find("phase")->text() == phase && one.find("from")->text() == from && one.find("to")->text() == to)
      return true;
  }
  return false;
}

}  // namespace

TEST_CASE("a run's batons are seen, and what happens to whom") {
  const Value seen = seen_of(R"({"protocol": "talkrobots", "robots": 3, "tasks": 6, "faults": [
      {"kind": "disk", "node": "cloud", "commit_s": 0.01}, {"at": 4, "kind": "kill", "node": "r2"},
      {"at": 5, "kind": "start", "node": "r2"}, {"at": 6, "kind": "partition", "nodes": ["r0", "cloud"]},
      {"at": 7, "kind": "heal", "nodes": ["r0", "cloud"]}]})");
  CHECK(is_sent(seen, "forward", "r0", "r1"));
  CHECK(told(seen) == std::vector<std::string>{"disk cloud", "kill r2", "start r2", "partition", "heal"});
  CHECK(seen.find("happenings")->list()[3].find("nodes")->list().size() == 2);
  CHECK(seen.find("sendings_not_listed")->integer() == 0);
  double last = 0;
  for (const Value& one : seen.find("sendings")->list()) {
    CHECK(one.find("at_s")->number() >= last);
    last = one.find("at_s")->number();
  }
}

TEST_CASE("a robot that breaks tells it, by an empty battery as well, which a repair does not charge") {
  const Value seen = seen_of(R"({"protocol": "talkrobots", "robots": 2, "tasks": 2, "seconds": 60, "faults": [
      {"kind": "battery", "node": "r0", "percent": 1, "per_second": 1}, {"at": 20, "kind": "repair", "node": "r0"}]})");
  CHECK(told(seen) == std::vector<std::string>{"battery r0", "fail r0", "repair r0", "fail r0"});
}

TEST_CASE("of the paper's protocol the messages between middlewares and the cloud are seen, as many as may be") {
  const Value seen = seen_of(R"({"robots": 5, "tasks": 9})");
  CHECK(is_sent(seen, "forward", "r0", "r1"));
  CHECK(seen.find("happenings")->list().empty());
  const Value many = seen_of(R"({"robots": 5, "tasks": 10000})");
  CHECK(many.find("sendings")->list().size() == kMaxSendings);
  CHECK(many.find("sendings_not_listed")->integer() > 0);
}
