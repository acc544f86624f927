// The main of a service: which arguments it accepts, and what prevents a start.
#include "common/service/service_main.hpp"

#include <doctest/doctest.h>

#include <filesystem>
#include <stdexcept>

#include "common/base/files.hpp"
#include "tests/support/node_folder.hpp"

using namespace trb;

namespace {

int ran = 0;  // how often a service was started

Result<int> ends_well(NodeConfig node) {
  ++ran;
  CHECK(node.id == "r1");
  return 0;
}
Result<int> cannot_start(NodeConfig) {
  ++ran;
  return fail(Errc::io_error, "state/journal.db: is locked", "end the other one");
}
Result<int> throws(NodeConfig) {
  ++ran;
  throw std::runtime_error("no memory");
}

int main_of(std::vector<std::string> words, Result<int> (*run)(NodeConfig)) {
  words.insert(words.begin(), "trb-scheduler");
  std::vector<char*> argv;
  argv.reserve(words.size());
  for (std::string& word : words) argv.push_back(word.data());
  ran = 0;
  return service_main(static_cast<int>(argv.size()), argv.data(),
                      {"scheduler", "Executes tasks.", "nodes/ur3", run, drivers::robot_transports});
}

}  // namespace

TEST_CASE("a service's main takes one folder, and says so") {
  CHECK(main_of({}, ends_well) == 2);
  CHECK(main_of({"a", "b"}, ends_well) == 2);
  CHECK(main_of({"--help"}, ends_well) == 0);
  CHECK(ran == 0);
}

TEST_CASE("a service whose folder has faults is not started") {
  const NodeFolder folder;
  CHECK(main_of({folder.path()}, ends_well) == 1);  // it has no keys
  CHECK(main_of({"/nowhere"}, ends_well) == 1);
  CHECK(ran == 0);
}

TEST_CASE("a service runs on a good folder; its exit status is the service's, or 1 if it could not start") {
  const NodeFolder folder;
  folder.sign(folder.check().config.id, Role::robot);
  CHECK(main_of({folder.path()}, ends_well) == 0);
  CHECK(ran == 1);
  CHECK(main_of({folder.path()}, cannot_start) == 1);
  CHECK(main_of({folder.path()}, throws) == 1);
  CHECK(ran == 1);
}

TEST_CASE("why a service could not start is in its log, if the node's folder has one") {
  const NodeFolder folder;
  folder.sign(folder.check().config.id, Role::robot);
  CHECK(main_of({folder.path()}, cannot_start) == 1);
  CHECK_FALSE(std::filesystem::exists(folder.path() + "/log"));
  std::filesystem::create_directory(folder.path() + "/log");
  CHECK(main_of({folder.path()}, cannot_start) == 1);
  const auto log = read_file(folder.path() + "/log/scheduler.log");
  REQUIRE(log.ok());
  CHECK(log->find("error scheduler not_started io_error: state/journal.db: is locked") != std::string::npos);
}
