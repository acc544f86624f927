#include "common/operator/decide.hpp"

#include "common/operator/test/fake_node.hpp"

using namespace trb;
using namespace trb::op;

namespace {

AlertDecide on_alert(Verdict verdict) {
  AlertDecide out;
  out.alert = "3f2a";
  out.verdict = verdict;
  return out;
}

AlertDecide on_run(Verdict verdict, const std::vector<std::string>& tasks = {"fetch"}) {
  AlertDecide out;
  out.run = "71c0";
  out.tasks = tasks;
  out.verdict = verdict;
  return out;
}

}  // namespace

TEST_CASE("a decision is on an alert, or on tasks of a run") {
  CHECK(check_decision(on_alert(Verdict::accept)).ok());
  CHECK(check_decision(on_run(Verdict::retry)).ok());
  CHECK(check_decision({}).error().what == "an alert, or a run and its tasks");
  AlertDecide both = on_run(Verdict::retry);
  both.alert = "3f2a";
  CHECK(check_decision(both).error().what == "an alert, or a run and its tasks");
  CHECK(check_decision(on_run(Verdict::retry, {})).error().what == "which tasks of the run");
}

TEST_CASE("tasks of a run are moved, retried or skipped; an override says why") {
  CHECK(check_decision(on_run(Verdict::none)).error().what == "what is to become of the tasks");
  CHECK(check_decision(on_run(Verdict::abort)).error().what == "what is to become of the tasks");
  CHECK(check_decision(on_alert(Verdict::abort)).ok());
  AlertDecide other = on_alert(Verdict::override_);
  CHECK(check_decision(other).error().hint == "--reason TEXT");
  other.reason = "it stands next to it";
  CHECK(check_decision(other).ok());
}

TEST_CASE("a decision is given to the node that decides, and taken or refused") {
  FakeNode node;
  Ending<Ack> ending;
  decide(node.session(), on_alert(Verdict::retry), ending);
  CHECK(node.take<AlertDecide>().verdict == Verdict::retry);
  SUBCASE("taken") {
    node.answer(Ack{"decided", "the same robot tries again"});
    CHECK(ending.value().text == "the same robot tries again");
  }
  SUBCASE("refused") {
    node.refuse(Errc::conflict, "it is decided already");
    CHECK(ending.error().code == Errc::conflict);
  }
}

TEST_CASE("another cloud node decides on the run: it gets the decision, on the run's tasks") {
  FakeNode node;
  Ending<Ack> ending;
  AlertDecide decision = on_alert(Verdict::accept);
  decision.person = "ann";
  decide(node.session(), decision, ending);
  node.take<AlertDecide>();
  node.answer(DecidedElsewhere{"cloud2", "71c0", {"fetch"}});
  const auto sent = node.take<AlertDecide>("cloud2");
  CHECK(sent.alert == "3f2a");
  CHECK(sent.run == "71c0");
  CHECK(sent.tasks == std::vector<std::string>{"fetch"});
  CHECK(sent.person == "ann");
  SUBCASE("it takes it") {
    node.answer(Ack{"accepted", "the run goes on"});
    CHECK(ending.value().text == "the run goes on");
  }
  SUBCASE("it is cut off") {
    node.pass(kAnswerWait);
    CHECK(ending.error().code == Errc::timeout);
  }
}

TEST_CASE("one that is not sound is not sent") {
  FakeNode node;
  Ending<Ack> ending;
  decide(node.session(), {}, ending);
  CHECK_FALSE(ending.has_come());
  node.pass(Duration::zero());
  CHECK(ending.error().code == Errc::missing);
  CHECK(node.is_quiet());
}
