#include "common/operator/try_robot.hpp"

#include "common/operator/test/fake_node.hpp"
#include "common/operator/try_cures.hpp"

using namespace trb;
using namespace trb::op;

namespace {

Opaque said(const std::string& word, const std::string& data) {
  return {word, data};
}

/// "ant" is the cloud node that a person tries "cart" from.
struct Trial {
  FakeNode node;
  Route row = cart("cart");
  std::vector<std::string> asked;   ///< skills
  std::vector<std::string> wanted;  ///< parameters, with their choices
  bool yes = false;
  TryWish wish{};  ///< what is named in it
  std::optional<std::string> word = "dock";
  Ending<std::vector<TryStep>> ending;

  void begin() {
    row.profile.framework = "pioneer";
    row.profile.mode = "direct";
    row.profile.transport = "arcos";
    try_robot(node.session(),
              {.robot = "cart",
               .person = {.may_try =
                              [this](const SkillInfo& skill, const std::function<void(bool)>& answer) {
                                asked.push_back(skill.name);
                                answer(yes);
                              },
                          .value_of =
                              [this](const SkillInfo& skill, const ParameterInfo& parameter,
                                     const std::vector<std::string>& choices,
                                     const std::function<void(std::optional<std::string>)>& answer) {
                                wanted.push_back(skill.name + "." + parameter.name);
                                for (const std::string& one : choices) wanted.back() += " " + one;
                                answer(word);
                              },
                          .see = {}},
               .skills = wish.skills,
               .parameters = wish.parameters,
               .must = wish.must,
               .connects = std::chrono::seconds(1)},
              ending);
  }
  void table() {
    node.take<RouteListRequest>();
    node.answer(RouteTable{"ant", {route_to("ant", Role::cloud, "self"), row}});
  }
  void position(const std::string& data = "[1,2,0]") {
    CHECK(node.take<Opaque>("cart").subtype == "position");
    node.answer(said("position", data));
  }
  void stop_and_release() {
    node.take<Stop>("cart");
    node.answer(Ack{"stopped", ""});
    row.profile.fenced = true;
    table();
    node.take<Release>("cart");
    node.answer(Ack{"released", ""});
    row.profile.fenced = false;
    table();
  }
  [[nodiscard]] const TryStep& step(const std::string& name) const {
    for (const TryStep& one : ending.value()) {
      if (one.name == name) return one;
    }
    FAIL("no step " << name);
    return ending.value().front();
  }
  [[nodiscard]] std::size_t failures() const {
    std::size_t out = 0;
    for (const TryStep& one : ending.value()) out += one.state == TryState::failed ? 1 : 0;
    return out;
  }
};

}  // namespace

TEST_CASE("a robot that does all it must, and no skill without a yes") {
  Trial trial;
  trial.begin();
  trial.table();
  trial.position();
  CHECK(trial.asked == std::vector<std::string>{"go_to"});
  trial.stop_and_release();
  CHECK(trial.failures() == 0);
  CHECK(trial.step("skill go_to").state == TryState::skipped);
  CHECK(trial.step("position").text == "[1,2,0]");
  CHECK(trial.wanted.empty());
  CHECK(trial.node.is_quiet());
}

TEST_CASE("a skill that a person has said yes to is a run of one task, which nobody else takes over") {
  Trial trial;
  trial.yes = true;
  trial.begin();
  trial.table();
  trial.position();
  CHECK(trial.wanted == std::vector<std::string>{"go_to.place dock"});
  trial.table();
  trial.node.pass(Duration::zero());
  const auto sign = trial.node.take<SignRequest>();
  const auto start = decode<RunStart>(sign.payload.bytes);
  REQUIRE(start.ok());
  REQUIRE(start->scenario.tasks.size() == 1);
  CHECK(start->scenario.tasks[0].data == R"({"place":"dock"})");
  CHECK(start->scenario.tasks[0].pinned);
  trial.node.answer(SignedRecord{"run_start", "ant", {"p"}, {"s"}});
  trial.node.take<RunSubmit>();
  trial.node.answer(RunAccepted{"3f2a0000"});
  trial.node.take<RunQuery>();
  RunView view = view_of_run(RunState::finished);
  view.tasks.resize(1);
  view.tasks[0].duration_s = 2;
  trial.node.answer(view);
  trial.stop_and_release();
  CHECK(trial.failures() == 0);
  CHECK(trial.step("skill go_to").text == "FINISHED in 2.0 s");
}

TEST_CASE(
    "a skill that fails: its run is ended, the file is named, and the robot is stopped and released all the same") {
  Trial trial;
  trial.yes = true;
  trial.begin();
  trial.table();
  trial.position();
  trial.table();
  trial.node.pass(Duration::zero());
  trial.node.take<SignRequest>();
  trial.node.answer(SignedRecord{"run_start", "ant", {"p"}, {"s"}});
  trial.node.take<RunSubmit>();
  trial.node.answer(RunAccepted{"3f2a0000"});
  trial.node.take<RunQuery>();
  RunView view = view_of_run(RunState::paused);
  view.tasks.resize(1);
  view.tasks[0].reason = "unknown_subtype: go_to";
  trial.node.answer(view);
  trial.node.take<RunQuery>();  // the order to abort begins with it
  trial.node.refuse(Errc::unknown_run, "gone");
  trial.stop_and_release();
  CHECK(trial.failures() == 1);
  CHECK(trial.step("skill go_to").cure.find("commands.json: pioneer.commands") != std::string::npos);
}

TEST_CASE("a parameter that nobody gives: the skill is not tried; one that is no such thing is told") {
  Trial trial;
  trial.yes = true;
  trial.row.profile.skills[0].parameters[0].type = "number";
  SUBCASE("none") {
    trial.word.reset();
    trial.begin();
    trial.table();
    trial.position();
    trial.stop_and_release();
    CHECK(trial.step("skill go_to").state == TryState::skipped);
    CHECK(trial.step("skill go_to").cure.find("--set go_to.place=") != std::string::npos);
  }
  SUBCASE("wrong") {
    trial.begin();
    trial.table();
    trial.position();
    trial.stop_and_release();
    CHECK(trial.step("skill go_to").text.find("'dock' is no number") != std::string::npos);
  }
}

TEST_CASE("a skill or parameter that the robot does not have is told, and nothing is tried") {
  Trial trial;
  trial.yes = true;
  const auto refused = [&](const std::string& what, const std::string& hint) {
    trial.begin();
    trial.table();
    CHECK(trial.ending.error().code == Errc::bad_value);
    CHECK(trial.ending.error().what.find(what) == 0);
    CHECK(trial.ending.error().hint.find(hint) == 0);
    CHECK(trial.node.is_quiet());
  };
  SUBCASE("skill") {
    trial.wish.skills = {"go_to", "goto"};
    refused("--skill: cart has no 'goto'", "did you mean 'go_to'?");
  }
  SUBCASE("parameter") {
    trial.wish.parameters = {"go_to.plac"};
    refused("--set: cart has no 'go_to.plac'", "did you mean 'go_to.place'?");
  }
}

TEST_CASE("a skill that was to be tried, and could not be, has failed") {
  Trial trial;
  trial.yes = true;
  trial.wish.skills = {"go_to"};
  trial.wish.must = true;
  trial.word.reset();
  trial.begin();
  trial.table();
  trial.position();
  trial.stop_and_release();
  CHECK(trial.step("skill go_to").state == TryState::failed);
  CHECK(trial.failures() == 1);
}

TEST_CASE("a robot that this node has commanded just now is tried once its control has ended") {
  Trial trial;
  trial.row.profile.control = "ant";
  trial.begin();
  trial.table();
  CHECK_FALSE(trial.ending.has_come());
  trial.row.profile.control.clear();
  trial.node.pass(std::chrono::milliseconds(300));
  trial.table();
  trial.position();
  trial.stop_and_release();
  CHECK(trial.step("free").state == TryState::good);
}

TEST_CASE("who is not there, not connected, stopped, commanded or broken is not tried any further") {
  Trial trial;
  const auto ends_with = [&](const std::string& step, const std::string& cure) {
    trial.begin();
    trial.table();
    while (!trial.ending.has_come()) {
      trial.node.pass(std::chrono::milliseconds(300));
      trial.table();
    }
    CHECK(trial.ending.value().back().name == step);
    CHECK(trial.failures() == 1);
    CHECK(trial.step(step).cure.find(cure) != std::string::npos);
    CHECK(trial.asked.empty());
    CHECK(trial.node.is_quiet());
  };
  SUBCASE("not there") {
    trial.row.state = "OFFLINE";
    ends_with("there", "trb up");
  }
  SUBCASE("not connected") {
    trial.row.profile.robot = "OFFLINE";
    ends_with("connected", "robot.host");
  }
  SUBCASE("stopped") {
    trial.row.profile.fenced = true;
    ends_with("free", "trb release cart");
  }
  SUBCASE("commanded") {
    trial.row.profile.control = "run 3f2a";
    ends_with("free", "trb scenario abort 3f2a");
  }
  SUBCASE("commanded from here, still") {
    trial.row.profile.control = "ant";
    ends_with("free", "10 s after its last command");
  }
  SUBCASE("broken") {
    trial.row.profile.out_of_use = {{"mobile", Severity::critical, "stalled", 1, false, ""}};
    ends_with("free", "repaired");
  }
}

TEST_CASE("a value that is no number, a request that nobody answers, a stop that is not confirmed") {
  Trial trial;
  trial.row.profile.sensors = {"battery", "mode"};
  trial.begin();
  trial.table();
  CHECK(trial.node.take<Opaque>("cart").subtype == "battery");
  trial.node.refuse(Errc::timeout, "no answer");
  trial.node.take<Opaque>("cart");
  trial.node.refuse(Errc::no_field_channel, "no such request");
  trial.position("[1,nan,0]");
  trial.node.take<Stop>("cart");
  trial.node.refuse(Errc::robot_offline, "gone");
  trial.node.take<Release>("cart");
  trial.node.answer(Ack{"released", ""});
  trial.table();
  CHECK(trial.failures() == 3);
  CHECK(trial.step("state mode").state == TryState::skipped);
  CHECK(trial.step("position").cure.find("pioneer.requests.position") != std::string::npos);
  CHECK(trial.step("stop").cure.find("commands.json: pioneer.commands.stop") != std::string::npos);
  CHECK(trial.step("release").state == TryState::good);
}

TEST_CASE("a stop that a standing robot confirms proves nothing, and is not called good") {
  Trial trial;
  trial.begin();
  trial.table();
  trial.position();
  trial.node.take<Stop>("cart");
  trial.node.answer(Ack{"stopped", "the robot was told; it stood already, so nothing is proved"});
  trial.row.profile.fenced = true;
  trial.table();
  trial.node.take<Release>("cart");
  trial.node.answer(Ack{"released", ""});
  trial.row.profile.fenced = false;
  trial.table();
  CHECK(trial.failures() == 0);
  CHECK(trial.step("stop").state == TryState::unproved);
  CHECK(trial.step("stop").text.find("nothing is proved: try it while it moves") != std::string::npos);
  CHECK(trial.step("release").state == TryState::good);
}

TEST_CASE("a robot that refuses the sign-in: what to put right is the sign-in, not the words for the order") {
  Trial trial;
  trial.begin();
  trial.table();
  trial.position();
  trial.node.take<Stop>("cart");
  trial.node.refuse(Errc::robot_error,
                    "the robot refused to stop: PUT /status was answered with 401, the robot refuses "
                    "the sign-in");
  trial.node.take<Release>("cart");
  trial.node.answer(Ack{"released", ""});
  trial.table();
  CHECK(trial.step("stop").text.starts_with("sent: robot_error"));
  CHECK(trial.step("stop").cure.find("commands.json") == std::string::npos);
  CHECK(trial.step("stop").cure.find("sha256sum") != std::string::npos);
}

TEST_CASE("a robot that only stands needs no position; one that is reached field by field has its own program") {
  Trial trial;
  trial.row.profile.capabilities = {"carry"};
  trial.begin();
  trial.table();
  trial.node.take<Opaque>("cart");
  trial.node.refuse(Errc::unknown_subtype, "no such request");
  trial.stop_and_release();
  CHECK(trial.step("position").state == TryState::skipped);
  NodeProfile fields;
  fields.mode = "interpreter";
  CHECK(cure_of_connection(fields).find("TCP_PORT") != std::string::npos);
  CHECK(cure_of_order(fields, "stop").find("conform") != std::string::npos);
}
