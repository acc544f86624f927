// What a robot's values mean: faults, reported once when they begin, and the state that the fleet receives.
#include "services/mode-adapter/core/fault_rules.hpp"

#include <cmath>

#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

FaultRule limit(FaultWhen when, double at, double rearm) {
  FaultRule rule;
  rule.name = "low";
  rule.value = "battery";
  rule.when = when;
  rule.limit = at;
  rule.rearm = rearm;
  rule.severity = Severity::urgent;
  rule.capability = "mobile";
  rule.text = "battery is low";
  return rule;
}

FaultRule about_text(FaultWhen when, Value wanted = {}) {
  FaultRule rule;
  rule.value = "error";
  rule.when = when;
  rule.wanted = std::move(wanted);
  return rule;
}

/// Rules, the clock of their test, and their reports.
struct Watch {
  explicit Watch(FaultRule rule) : rules{std::move(rule)} {}

  /// The texts that this value causes.
  std::vector<std::string> hear(std::vector<double> numbers, const std::string& json) {
    FaultChanges changes;
    watch.on_value(rules[0].value, {std::move(numbers), json, now.mono}, now, changes);
    over += static_cast<int>(changes.over.size());
    return texts(changes.said);
  }
  std::vector<std::string> hear(double number) { return hear({number}, std::to_string(int(number))); }
  std::vector<std::string> wait(double time_s) {
    FaultChanges changes;
    now.mono = now.mono + seconds(time_s);
    watch.tick(now, changes);
    return texts(changes.said);
  }
  static std::vector<std::string> texts(const std::vector<FaultSaid>& told) {
    std::vector<std::string> out;
    for (const FaultSaid& fault : told) {
      if (fault.is_new) out.push_back(fault.text);
    }
    return out;
  }

  std::vector<FaultRule> rules;
  FaultRules watch{rules};
  int over = 0;  ///< how often it was reported as over
  Now now{{seconds(1000).count()}, {}};
};

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("a limit is told when it is passed, and again only after the value has come back by far enough") {
  Watch watch(limit(FaultWhen::below, 20, 25));
  CHECK(watch.hear(40).empty());
  CHECK(watch.hear(20).empty());
  CHECK(watch.hear(19) == Texts{"battery is low: battery is 19"});
  CHECK(watch.hear(18).empty());
  watch.wait(60);
  CHECK(watch.hear(24).empty());  // above the limit, but not far enough
  CHECK(watch.hear(19).empty());
  CHECK(watch.hear(25).empty());
  CHECK(watch.hear(10) == Texts{"battery is low: battery is 10"});
}

TEST_CASE("above: of several numbers one begins it, and all have to come back") {
  Watch watch(limit(FaultWhen::above, 70, 60));
  CHECK(watch.hear({50, 71, 20}, "[50,71,20]") == Texts{"battery is low: battery is [50,71,20]"});
  watch.wait(60);
  CHECK(watch.hear({50, 61, 20}, "").empty());
  CHECK(watch.hear({50, 80, 20}, "").empty());
  CHECK(watch.hear({50, 60, 20}, "").empty());
  CHECK(watch.hear({50, 80, 20}, "x").size() == 1);
}

TEST_CASE("what is no number neither begins nor ends a fault") {
  Watch watch(limit(FaultWhen::below, 20, 25));
  CHECK(watch.hear({std::nan("")}, "").empty());
  CHECK(watch.hear({}, "\"unknown\"").empty());
  CHECK(watch.hear(1).size() == 1);
  watch.wait(60);
  CHECK(watch.hear({}, "").empty());
  CHECK(watch.hear({std::nan("")}, "").empty());
  CHECK(watch.hear(1).empty());
}

TEST_CASE("a value that flaps over its limits is told once in ten seconds, and not at all once it is over") {
  Watch watch(limit(FaultWhen::below, 20, 25));
  std::size_t told = 0;
  for (int i = 0; i < 300; ++i) {  // 30 s at 10 Hz
    told += watch.hear(i % 2 == 0 ? 19 : 30).size();
    told += watch.wait(0.1).size();
  }
  CHECK(told == 3);
  watch.wait(60);
  CHECK(watch.hear(30).empty());
  CHECK(watch.hear(19).size() == 1);
  CHECK(watch.hear(30).empty());
  CHECK(watch.hear(19).empty());  // begun again, and waiting
  REQUIRE(watch.watch.next_deadline());
  CHECK(watch.hear(30).empty());
  CHECK_FALSE(watch.watch.next_deadline());
  CHECK(watch.wait(60).empty());
}

TEST_CASE("a fault that begins again within ten seconds and stays is told when they have passed") {
  Watch watch(limit(FaultWhen::below, 20, 25));
  CHECK(watch.hear(19).size() == 1);
  CHECK(watch.hear(30).empty());
  CHECK(watch.hear(7).empty());
  CHECK(watch.wait(9).empty());
  CHECK(watch.wait(1.1) == Texts{"battery is low: battery is 7"});
  CHECK(watch.wait(60).empty());
}

TEST_CASE("equals: a text, a number, true or false") {
  Watch words(about_text(FaultWhen::equals, Value{std::string("stuck")}));
  CHECK(words.hear({}, "\"fine\"").empty());
  CHECK(words.hear({}, "\"stuck\"") == Texts{"stuck"});
  Watch number(about_text(FaultWhen::equals, Value{std::int64_t{3}}));
  CHECK(number.hear({2}, "2").empty());
  CHECK(number.hear({3}, "3") == Texts{"error is 3"});
  Watch flag(about_text(FaultWhen::equals, Value{true}));
  CHECK(flag.hear({0}, "false").empty());
  CHECK(flag.hear({1}, "true") == Texts{"error is true"});
}

TEST_CASE("changes: each new text of the robot's is told in its own words, its first one and an empty one are not") {
  Watch watch(about_text(FaultWhen::changes));
  CHECK(watch.hear({}, "\"old news\"").empty());
  CHECK(watch.hear({}, "\"old news\"").empty());
  CHECK(watch.hear({}, "\"wheel \\\"2\\\" slips\\nbadly\"") == Texts{"wheel \"2\" slips\nbadly"});
  watch.wait(20);
  CHECK(watch.hear({}, "\"\"").empty());
  CHECK(watch.hear({}, "\"motor hot\"") == Texts{"motor hot"});
}

TEST_CASE("what takes a capability now: by the last value, told or not, CRITICAL at least, until the robot leaves") {
  FaultRule low = limit(FaultWhen::below, 20, 30);
  Watch mild(low);
  mild.hear(10);
  CHECK(mild.watch.standing("mobile") == nullptr);
  low.severity = Severity::critical;
  Watch watch(low);
  CHECK(watch.watch.standing("mobile") == nullptr);
  watch.hear(10);
  REQUIRE(watch.watch.standing("mobile") != nullptr);
  CHECK(watch.watch.standing("carry") == nullptr);
  watch.hear(25);  // not far enough back
  CHECK(watch.watch.standing("mobile") != nullptr);
  watch.hear(31);
  CHECK(watch.watch.standing("mobile") == nullptr);
  watch.hear(10);  // not reported again so soon, but it stands
  CHECK(watch.watch.standing("mobile") != nullptr);
  watch.watch.forget_standing();
  CHECK(watch.watch.standing("mobile") == nullptr);
}

TEST_CASE("a rule says that its fault is over once the value has come back by far enough, begun or not") {
  Watch watch(limit(FaultWhen::below, 20, 25));
  watch.hear(19);
  watch.hear(24);
  CHECK(watch.over == 0);
  watch.hear(25);
  CHECK(watch.over == 1);
  Watch after_a_restart(limit(FaultWhen::below, 20, 25));
  after_a_restart.hear(30);
  CHECK(after_a_restart.over == 1);
  Watch words(about_text(FaultWhen::changes));
  words.hear({}, "\"motor hot\"");
  words.hear({}, "\"motor very hot\"");
  CHECK(words.over == 0);
  words.hear({}, "\"\"");
  CHECK(words.over == 1);
}

TEST_CASE("after a person's word a rule that is met begins anew") {
  Watch watch(limit(FaultWhen::below, 20, 25));
  watch.hear(19);
  watch.wait(20);
  CHECK(watch.hear(18).empty());
  watch.watch.begin_again("grab");
  CHECK(watch.hear(18).empty());
  watch.watch.begin_again("mobile");
  CHECK(watch.hear(18).size() == 1);
}

TEST_CASE("in fields a value is what the robot tells its own node") {
  Settings settings = pioneer();
  settings.description.faults = {limit(FaultWhen::below, 20, 25)};
  Fixture fixture(settings);
  fixture.up(Channel::field);
  fixture.say("information\nbattery\n\n2\n19\n");
  const auto faults = sent<RobotFault>(fixture.out);
  REQUIRE(faults.size() == 1);
  CHECK(faults[0].capability == "mobile");
  CHECK(faults[0].severity == Severity::urgent);
  CHECK(faults[0].text == "battery is low: battery is 19");
}

TEST_CASE("sensors are told to every node at their first word and when one changes, once a second at most") {
  Settings settings = pioneer();
  settings.description.sensors = {"battery", "pose"};
  Fixture fixture(settings);
  fixture.up(Channel::field);
  const auto told = [&] {
    const auto states = sent<RobotState>(fixture.out);
    fixture.out.clear();
    return states;
  };
  fixture.say("information\nbattery\n\n2\n19\n");
  const auto first = told();
  REQUIRE(first.size() == 1);
  REQUIRE(first[0].values.size() == 1);
  CHECK(first[0].values[0].value == "19");
  for (const char* next : {"18", "17", "16"}) fixture.say(std::string("information\nbattery\n\n2\n") + next + "\n");
  CHECK(told().empty());
  fixture.wait(1.1);
  const auto later = told();
  REQUIRE(later.size() == 1);
  CHECK(later[0].values[0].value == "16");
  fixture.say("information\npose\n\n5\n[1,2]\n");
  fixture.wait(1.1);
  CHECK(told().size() == 1);
  fixture.say("information\npose\n\n5\n[1,3]\n");  // it only moves
  fixture.wait(5);
  CHECK(told().empty());
}
