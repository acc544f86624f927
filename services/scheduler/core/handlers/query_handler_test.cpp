#include "services/scheduler/core/handlers/query_handler.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/test/known_run.hpp"

using namespace trb;
using namespace trb::scheduler;
using namespace trb::scheduler::test;

namespace {

struct Showing {
  template <class Query>
  Outbox ask(const Query& query) {
    return known.send(handler, "drone", query, MessageType::request);
  }
  Outbox at_end_of_step() {
    Outbox out;
    handler.notify_watchers(known.step(out));
    return out;
  }
  KnownRun known{chain({"ur3", "drone"})};
  Watchers watchers;
  QueryHandler handler{known.runs, known.archive, known.executor, watchers};
};

}  // namespace

TEST_CASE("a run is found by its id, by a beginning of it, or as the newest") {
  Showing showing;
  for (const std::string& name : {kKnownRun, kKnownRun.substr(0, 4), std::string()}) {
    const auto views = sent<RunView>(showing.ask(RunQuery{name}));
    REQUIRE(views.size() == 1);
    CHECK(views[0].run == kKnownRun);
  }
  CHECK(nacks(showing.ask(RunQuery{"b"})) == std::vector<std::string>{"unknown_run"});
}

TEST_CASE("open runs are listed with how many there may be; a page has a bound") {
  Showing showing;
  const auto tables = sent<RunTable>(showing.ask(RunListRequest{}));
  REQUIRE(tables.size() == 1);
  CHECK(tables[0].runs.size() == 1);
  CHECK(tables[0].open_max == RunStore::kMaxRuns);
  RunListRequest all;
  all.all = true;
  all.most = 501;
  CHECK(nacks(showing.ask(all)) == std::vector<std::string>{"bad_value"});
}

TEST_CASE("who watches is told of what changes, once, until the lease ends") {
  Showing showing;
  CHECK(showing.at_end_of_step().sends.empty());
  CHECK(sent<RunTable>(showing.ask(RunWatch{10})).size() == 1);
  CHECK(showing.at_end_of_step().sends.empty());
  showing.known.finish("task-0");
  CHECK(targets<RunChanged>(showing.at_end_of_step()) == std::vector<std::string>{"drone"});
  CHECK(showing.at_end_of_step().sends.empty());
  showing.known.pass(11);
  showing.known.finish("task-1");
  CHECK(showing.at_end_of_step().sends.empty());
}
