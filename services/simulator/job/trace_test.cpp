#include "services/simulator/job/trace.hpp"

#include <doctest/doctest.h>

#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <sstream>

#include "common/base/files.hpp"
#include "common/base/test/temporary_folder.hpp"

using namespace trb;
using namespace trb::simulator;

namespace {

const std::string kTracedJob = R"({"protocol": "talkrobots", "robots": 2, "tasks": 3, "seed": 6, "link": "wifi")";

struct Kept {
  Value job;
  std::vector<Value> messages;
};

Kept kept_trace() {
  ConfigFaults faults;
  const std::string text = kTracedJob + R"(, "trace": "here"})";
  const Job job = read_job(text, faults);
  REQUIRE(faults.empty());
  Trace trace(text);
  world::World world(*job.world);
  world.meter().trace = [&](const world::Sending& sending, CostPhase phase) { trace.on(world, sending, phase); };
  world.play();
  Kept out;
  std::istringstream lines(trace.text());
  std::string line;
  std::getline(lines, line);
  out.job = *parse_json(line)->find("job");
  while (std::getline(lines, line)) out.messages.push_back(*parse_json(line));
  return out;
}

Value state_at(const Value& job, std::int64_t event) {
  Value with = job;
  std::get<Value::Object>(with.is).emplace_back("until_event", Value{event});
  ConfigFaults faults;
  const Job read = read_job(dump_json(with), faults);
  REQUIRE_MESSAGE(faults.empty(), to_text(faults));
  world::World world(*read.world);
  const world::Played played = world.play();
  CHECK(played.cut_short);
  CHECK(played.broken.empty());
  return state_value(world);
}

}  // namespace

TEST_CASE("a trace's own job plays the same to any of its events") {
  const Kept kept = kept_trace();
  CHECK(kept.job.find("trace") == nullptr);
  REQUIRE(kept.messages.size() > 100);
  for (const std::size_t at : {std::size_t{0}, kept.messages.size() / 2, kept.messages.size() - 1}) {
    CAPTURE(at);
    const std::int64_t event = kept.messages[at].find("event")->integer();
    std::size_t last = at;
    while (last + 1 < kept.messages.size() && kept.messages[last + 1].find("event")->integer() == event) ++last;
    const Value state = state_at(kept.job, event);
    CHECK(state.find("event")->integer() == event);
    CHECK(state.find("messages")->integer() == static_cast<std::int64_t>(last + 1));
    CHECK(state.find("digest")->text() == kept.messages[last].find("digest")->text());
    CHECK(state.find("nodes")->list().size() == 3);
  }
}

TEST_CASE("the state at an event says what each robot does") {
  const Kept kept = kept_trace();
  const auto told = std::ranges::find_if(
      kept.messages, [](const Value& message) { return message.find("subtype")->text() == Execute::kSubtype; });
  REQUIRE(told != kept.messages.end());
  const std::int64_t event = told->find("event")->integer();
  const Value before = state_at(kept.job, event);
  CHECK(before.find("nodes")->list()[1].find("robot")->text() == "idle");
  CHECK(before.find("nodes")->list()[0].find("run")->text() == "OPEN");
  const Value during = state_at(kept.job, event + 100);
  CHECK(during.find("nodes")->list()[1].find("robot")->text() == "works on t0");
}

TEST_CASE("a trace that is written has a last line, which says that it is complete") {
  Trace trace("{}");
  ConfigFaults faults;
  world::World world(*read_job(kTracedJob + "}", faults).world);
  trace.on(world, {0, "r0", "cloud", "baton", 1, true}, CostPhase::forward);
  CHECK(trace.text().find("complete") == Bytes::npos);
  const auto file = std::filesystem::temp_directory_path() / ("trb-trace-" + std::to_string(::getpid()));
  REQUIRE(trace.write(file.string()).ok());
  const auto text = read_file(file.string());
  std::filesystem::remove(file);
  REQUIRE(text.ok());
  CHECK(text->ends_with("}\n{\"complete\":true,\"messages\":1}\n"));
}

TEST_CASE("a trace is full behind its last message") {
  Trace trace("{}", 2);
  ConfigFaults faults;
  world::World world(*read_job(kTracedJob + "}", faults).world);
  const world::Sending sending{0, "r0", "cloud", "baton", 1, true};
  for (int i = 0; i < 2; ++i) trace.on(world, sending, CostPhase::forward);
  CHECK_FALSE(trace.is_too_long());
  trace.on(world, sending, CostPhase::forward);
  CHECK(trace.is_too_long());
  CHECK(trace.write("/nowhere/x").error().code == Errc::too_large);
}

TEST_CASE("a trace that cannot be written is known before anything is played") {
  CHECK(check_place("trace.jsonl").ok());
  CHECK(check_place("/tmp/trace.jsonl").ok());
  CHECK(check_place("/nowhere/trace.jsonl").error().code == Errc::io_error);
  CHECK_FALSE(check_place("/tmp").ok());
  CHECK_FALSE(check_place("/dev/null/trace.jsonl").ok());
  const TemporaryFolder folder;
  REQUIRE(::mkfifo((folder.path + "/pipe").c_str(), 0600) == 0);
  std::filesystem::create_symlink(folder.path + "/file", folder.path + "/link");
  REQUIRE(write_file(folder.path + "/file", "a trace", 0644).ok());
  CHECK(check_place(folder.path + "/file").ok());
  CHECK_FALSE(check_place(folder.path + "/pipe").ok());
  CHECK_FALSE(check_place(folder.path + "/link").ok());
}
