// A service that cannot open its files: what it says to others meanwhile, and that it goes on by itself.
#include "common/service/waiting.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>

#include "common/base/test/temporary_folder.hpp"

using namespace trb;

namespace {

const Error kFull = fail(Errc::io_error, "/n/state/journal.db: database or disk is full", "make room");

Outbox answer_to(MessageType type, std::uint64_t reply_to = 0) {
  WaitingCore core(kFull);
  Outbox out;
  core.on({type, "ant", "ant", 7, reply_to, 0, kDefaultRemainingMs, RunListRequest{}}, {}, out);
  return out;
}

}  // namespace

TEST_CASE("while a service waits it refuses what it is asked, with the reason and the cure") {
  const auto nacks = sent<Nack>(answer_to(MessageType::request));
  REQUIRE(nacks.size() == 1);
  CHECK(nacks[0].code == "no_service");
  CHECK(nacks[0].what == "it waits: /n/state/journal.db: database or disk is full");
  CHECK(nacks[0].hint == "make room");
  CHECK(sent<Nack>(answer_to(MessageType::command)).size() == 1);
}

TEST_CASE("what a service waits for is noted with the cure, as long as a note may be") {
  CHECK(waits_of(kFull) == "/n/state/journal.db: database or disk is full; make room");
  const std::string cut = waits_of(fail(Errc::io_error, std::string(400, 'x'), "make room"));
  const ServiceHello hello{"scheduler", {}, 1, 1, "1", {}, cut};
  CHECK(decode<ServiceHello>(encode(hello)).ok());
  CHECK(cut.size() > 200);
}

TEST_CASE("while a service waits it lets answers and information pass") {
  CHECK(answer_to(MessageType::information).empty());
  CHECK(answer_to(MessageType::request, 5).empty());
}

TEST_CASE("files that open need no waiting, and a fault that waiting does not mend ends the service") {
  const TemporaryFolder folder;
  const ServiceOptions options{folder.path, "scheduler", {}};
  const auto open = wait_for_files(options, [] { return Status(Done{}); });
  REQUIRE(open);
  CHECK_FALSE(*open);
  const auto damaged = wait_for_files(options, [] { return Status(fail(Errc::malformed, "journal.db: damaged")); });
  REQUIRE_FALSE(damaged);
  CHECK(damaged.error().code == Errc::malformed);
}

TEST_CASE("files that cannot be opened are tried again until they can") {
  const TemporaryFolder folder;
  std::filesystem::create_directory(folder.path + "/bus");
  std::ofstream(folder.path + "/node.json") << R"({"id":"ant"})";
  int tries = 0;
  const auto open = wait_for_files({folder.path, "scheduler", {}}, [&]() -> Status {
    if (++tries < 3) return kFull;
    return Done{};
  });
  std::filesystem::current_path("/");
  REQUIRE(open);
  CHECK_FALSE(*open);
  CHECK(tries == 3);
}
