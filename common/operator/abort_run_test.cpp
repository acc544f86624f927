// Orders to a run: abort, pause, resume. Each is signed by the node, then sent to its scheduler.
#include "common/operator/abort_run.hpp"

#include "common/operator/pause_run.hpp"
#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

/// The node signs the record that it is asked to sign; returns that record.
template <class Order>
Order sign(FakeNode& node, std::string_view kind) {
  const auto question = node.take<SignRequest>();
  SignedRecord record;
  record.payload.bytes = question.payload.bytes;
  node.answer(record);
  const auto order = decode<Order>(question.payload.bytes);
  CHECK(question.kind == kind);
  REQUIRE(order.ok());
  return *order;
}

}  // namespace

TEST_CASE("a run is aborted, and looked at until every member has confirmed") {
  FakeNode node;
  Ending<RunView> ending;
  abort_run(node.session(), {"3f2a", "wrong box"}, ending);
  CHECK(node.take<RunQuery>().run == "3f2a");
  node.answer(view_of_run(RunState::running));
  const auto order = sign<AbortOrder>(node, kSignedRunAbort);
  CHECK(order.run == "3f2a0000");
  CHECK(order.by == "ant");
  CHECK(order.reason == "wrong box");
  CHECK(order.time == node.now().utc.ns);
  node.take<RunAbort>();
  node.answer(Ack{"aborting", ""});
  CHECK(node.take<RunQuery>().run == "3f2a0000");
  SUBCASE("they confirm") {
    node.answer(view_of_run(RunState::aborting));
    CHECK(node.is_quiet());
    node.pass(std::chrono::milliseconds(100));
    node.take<RunQuery>();
    node.answer(view_of_run(RunState::aborted));
    CHECK(ending.value().state == RunState::aborted);
  }
  SUBCASE("one does not, and the time is over") {
    for (int i = 0; i < 50; ++i) {
      node.answer(view_of_run(RunState::aborting));
      node.pass(std::chrono::milliseconds(100));
      if (!ending.has_come()) node.take<RunQuery>();
    }
    CHECK(ending.value().state == RunState::aborting);
  }
  SUBCASE("it cannot be read any more: it was accepted all the same") {
    node.answer(view_of_run(RunState::aborting));
    node.pass(std::chrono::milliseconds(100));
    for (int i = 0; !ending.has_come() && i < 100; ++i) {
      node.take<RunQuery>();
      node.refuse(Errc::no_service, "the scheduler has ended");
      node.pass(std::chrono::milliseconds(100));
    }
    CHECK(ending.value().state == RunState::aborting);
  }
}

TEST_CASE("an abort ends with the first thing that fails") {
  FakeNode node;
  Ending<RunView> ending;
  abort_run(node.session(), {"3f2a", ""}, ending);
  node.take<RunQuery>();
  SUBCASE("the run is not known") {
    node.refuse(Errc::unknown_run, "no run '3f2a'");
    CHECK(ending.error().code == Errc::unknown_run);
  }
  SUBCASE("the router does not sign") {
    node.answer(view_of_run(RunState::running));
    node.take<SignRequest>();
    node.refuse(Errc::not_permitted, "no");
    CHECK(ending.error().code == Errc::not_permitted);
  }
  SUBCASE("the scheduler says nothing") {
    node.answer(view_of_run(RunState::running));
    sign<AbortOrder>(node, kSignedRunAbort);
    node.take<RunAbort>();
    node.pass(std::chrono::seconds(5));
    CHECK(ending.error().code == Errc::timeout);
  }
  CHECK(node.is_quiet());
}

TEST_CASE("who lets a run go on has seen what was done twice; who holds it need not") {
  FakeNode node;
  Ending<RunView> ending;
  RunView run = view_of_run(RunState::paused);
  run.pause_number = 4;
  run.tasks.resize(2);
  run.tasks[0].id = "fetch";
  run.tasks[1].id = "carry";
  run.tasks[1].twice = true;
  bool holds = false;
  SUBCASE("resume") {
    resume_run(node.session(), "3f2a", "clean again", ending);
  }
  SUBCASE("pause") {
    holds = true;
    pause_run(node.session(), "3f2a", "clean again", ending);
  }
  node.take<RunQuery>();
  node.answer(run);
  const auto order = sign<PauseOrder>(node, kSignedRunPause);
  CHECK(order.number == 5);
  CHECK(order.paused == holds);
  CHECK(order.reason == "clean again");
  CHECK(order.doubles == (holds ? std::vector<std::string>{} : std::vector<std::string>{"carry"}));
  node.take<RunPause>();
  node.answer(Ack{"held", ""});
  CHECK(node.take<RunQuery>().run == "3f2a0000");
  node.answer(view_of_run(RunState::running));
  CHECK(ending.value().state == RunState::running);
}

TEST_CASE("an order that was accepted is no error, though the run cannot be read then") {
  for (const bool holds : {true, false}) {
    FakeNode node;
    Ending<RunView> ending;
    (holds ? pause_run : resume_run)(node.session(), "3f2a", "why", ending);
    node.take<RunQuery>();
    node.answer(view_of_run(holds ? RunState::running : RunState::paused));
    sign<PauseOrder>(node, kSignedRunPause);
    node.take<RunPause>();
    node.answer(Ack{"held", ""});
    node.take<RunQuery>();
    node.refuse(holds ? Errc::no_service : Errc::queue_full, "not now");
    CHECK(ending.value().state == (holds ? RunState::paused : RunState::running));
    CHECK(ending.value().pause_number == 1);
    CHECK(ending.value().paused_by == (holds ? "ant" : ""));
  }
}
