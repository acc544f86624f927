#include "services/scheduler/core/handlers/query_handler.hpp"

#include <doctest/doctest.h>

#include "services/scheduler/core/signed_records.hpp"
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

/// Knows of one run, and cannot read its record.
class DamagedArchive final : public Archive {
 public:
  [[nodiscard]] Status has_room(const std::string&) const override { return Done{}; }
  [[nodiscard]] std::optional<Over> over(const std::string&) const override { return Over{RunState::finished, {}}; }
  [[nodiscard]] Result<JournalArchive> record(const std::string&) const override {
    return fail(Errc::io_error, "damaged");
  }
  [[nodiscard]] std::vector<std::string> ids(const std::string&, std::size_t) const override { return {}; }
  [[nodiscard]] ArchivePage page(const std::string&, std::size_t) const override { return {}; }
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

TEST_CASE("what is signed of a run is there while it is open, and when it is over") {
  Showing showing;
  showing.known.finish("task-0");
  const auto open = sent<RunRecords>(showing.ask(RunProofRequest{kKnownRun.substr(0, 4)}));
  REQUIRE(open.size() == 1);
  CHECK(open[0].run == kKnownRun);
  REQUIRE(open[0].records.size() == 2);
  CHECK(open[0].records[0] == showing.known.start);
  CHECK(open[0].records[1].kind == kSignedResult);
  JournalArchive fact;
  fact.view.run = kKnownRun;
  SUBCASE("from its archive") {
    put_signed_records(showing.known.run(), fact);
    showing.known.runs.remove(kKnownRun);
    showing.known.archive.put(fact);
    const auto over = sent<RunRecords>(showing.ask(RunProofRequest{kKnownRun, 1}));
    REQUIRE(over.size() == 1);
    CHECK(over[0].count == 2);
    CHECK(over[0].records == std::vector{open[0].records[1]});
  }
  SUBCASE("unless an earlier version kept it without its start") {
    showing.known.runs.remove(kKnownRun);
    showing.known.archive.put(fact);
    CHECK(nacks(showing.ask(RunProofRequest{kKnownRun})) == std::vector<std::string>{"missing"});
  }
  SUBCASE("or it is not known") {
    CHECK(nacks(showing.ask(RunProofRequest{"b"})) == std::vector<std::string>{"unknown_run"});
  }
}

TEST_CASE("a record that has made room, and one that cannot be read, are refused for what they are") {
  Showing showing;
  showing.known.runs.remove(kKnownRun);
  showing.known.archive.keep_most(0);
  JournalArchive fact;
  fact.view.run = kKnownRun;
  showing.known.archive.put(fact);
  const DamagedArchive damaged;
  QueryHandler other{showing.known.runs, damaged, showing.known.executor, showing.watchers};
  const auto ask = [&](QueryHandler& handler, const auto& query) {
    return nacks(showing.known.send(handler, "drone", query, MessageType::request));
  };
  CHECK(ask(showing.handler, RunQuery{kKnownRun}) == std::vector<std::string>{"expired"});
  CHECK(ask(showing.handler, RunProofRequest{kKnownRun}) == std::vector<std::string>{"expired"});
  CHECK(ask(other, RunQuery{kKnownRun}) == std::vector<std::string>{"io_error"});
  CHECK(ask(other, RunProofRequest{kKnownRun}) == std::vector<std::string>{"io_error"});
}

TEST_CASE("a page has as many records as fit a message, one at least") {
  const std::vector<SignedRecord> all(5, {"result", "ur3", {Bytes(200'000, 'x')}, {}});
  CHECK(page_of(all, 0).records.size() == 2);
  CHECK(page_of(all, 4).records.size() == 1);
  CHECK(page_of(all, 5).records.empty());
  CHECK(page_of(all, 4'000'000'000).records.empty());
  CHECK(page_of({{"run_start", "cloud", {Bytes(524'288, 'x')}, {}}}, 0).records.size() == 1);
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
  showing.known.run().reports().note_progress(1, TaskState::running);
  CHECK(targets<RunChanged>(showing.at_end_of_step()) == std::vector<std::string>{"drone"});
  showing.known.run().reports().note_progress(1, TaskState::running);  // the same again
  CHECK(showing.at_end_of_step().sends.empty());
  showing.known.pass(11);
  showing.known.finish("task-1");
  CHECK(showing.at_end_of_step().sends.empty());
}
