// What keeps a robot out of use: it stands until its end is reported, over restarts and full disks.
#include "services/mode-adapter/io/out_of_use_file.hpp"

#include <filesystem>

#include "common/base/files.hpp"
#include "common/base/test/temporary_folder.hpp"
#include "services/mode-adapter/test/fixture.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

FaultRule rule(const std::string& name, double at, const std::string& capability = "mobile") {
  FaultRule out;
  out.name = name;
  out.value = name;
  out.when = FaultWhen::above;
  out.limit = at;
  out.rearm = at;
  out.severity = Severity::critical;
  out.capability = capability;
  out.text = name;
  return out;
}

Settings with_rules() {
  Settings settings = pioneer();
  settings.description.capabilities = {"mobile", "carry"};
  settings.description.faults = {rule("heat", 70), rule("current", 5), rule("gripper", 1, "carry")};
  return settings;
}

/// A robot that sends values in fields, and a scheduler that orders it to go home.
struct Robot : Fixture {
  explicit Robot(Settings settings = with_rules()) : Fixture(std::move(settings)) {
    up(Channel::field);
    welcome();
  }
  void tell(const std::string& name, int value) {
    const std::string number = std::to_string(value);
    say("information\n" + name + "\n\n" + std::to_string(number.size()) + "\n" + number + "\n");
  }
  void fault(const std::string& words) {
    say("information\nfault\n\n" + std::to_string(words.size()) + "\n" + words + "\n");
  }
  std::string go_home() { return answer(deliver(MessageType::command, order("home", "", ++tried), "pioneer")); }
  std::string retire(const std::string& by = "operator") {
    return answer(deliver(MessageType::command, TakeOutOfUse{{"", {}, "new wheels", 0, true, by}}));
  }
  std::string mend(const std::string& capability = {}) {
    return answer(deliver(MessageType::command, TakeIntoUse{capability, false, "ann"}));
  }
  std::string give_back() { return answer(deliver(MessageType::command, TakeIntoUse{"", true, "ann"})); }
  std::uint32_t tried = 0;
};

using Texts = std::vector<std::string>;

}  // namespace

TEST_CASE("a critical fault keeps what it takes out of use until the robot says that it is over") {
  Robot robot;
  robot.out.clear();
  robot.tell("heat", 80);
  REQUIRE(robot.kept.size() == 1);
  CHECK(robot.kept[0].cause == "rule heat");
  const auto profile = robot.one<NodeProfile>();
  REQUIRE(profile.out_of_use.size() == 1);
  CHECK(profile.out_of_use[0].capability == "mobile");
  CHECK(profile.out_of_use[0].text == "heat: heat is 80");
  CHECK(robot.one<AdapterState>().out_of_use == profile.out_of_use);
  CHECK(robot.go_home() == "nack out_of_use");
  CHECK(robot.over().empty());
  robot.out.clear();
  robot.tell("heat", 60);
  CHECK(robot.kept.empty());
  CHECK(robot.over() == Texts{"mobile: heat: heat is 80"});
  CHECK(robot.one<NodeProfile>().out_of_use.empty());
  robot.wait(20);
  CHECK(robot.go_home() == "running");
}

TEST_CASE("a person's command goes to a robot that is out of use") {
  Robot robot;
  robot.tell("heat", 80);
  robot.retire();
  const auto id = robot.command("home", "");
  robot.take_fields();
  CHECK(robot.answer(id) == "ack handed_over");
}

TEST_CASE("of two faults of one capability the end of one leaves the other, and nothing is told to be whole") {
  Robot robot;
  robot.tell("heat", 80);
  robot.tell("current", 9);
  CHECK(robot.kept.size() == 2);
  robot.out.clear();
  robot.tell("heat", 20);
  CHECK(robot.over().empty());
  CHECK(robot.one<NodeProfile>().out_of_use.size() == 1);
  CHECK(robot.go_home() == "nack out_of_use");
  robot.tell("current", 1);
  CHECK(robot.over() == Texts{"mobile: current: current is 9"});
}

TEST_CASE("what needs another capability goes on; a fault of the whole robot takes every one") {
  Robot robot;
  robot.tell("gripper", 2);
  CHECK(robot.go_home() == "running");
  Settings settings = with_rules();
  settings.description.faults = {rule("plug", 1, "")};
  Robot other(settings);
  other.tell("plug", 2);
  CHECK(other.go_home() == "nack out_of_use");
  other.out.clear();
  other.tell("plug", 0);
  CHECK(other.over() == Texts{"mobile: plug: plug is 2", "carry: plug: plug is 2"});
}

TEST_CASE("a fault outlives the process, and its end is heard by the next one") {
  Settings settings = with_rules();
  settings.out_of_use = {{"rule heat", {"mobile", Severity::critical, "hot", 5, false, ""}}};
  Robot robot(settings);
  CHECK(robot.one<AdapterState>().out_of_use.size() == 1);
  CHECK(robot.go_home() == "nack out_of_use");
  robot.tell("heat", 20);
  CHECK(robot.over() == Texts{"mobile: hot"});
  CHECK(robot.go_home() == "running");
}

TEST_CASE("a person's word ends a fault whose end nobody tells, and is refused while the robot still tells it") {
  Robot robot;
  robot.fault("mobile CRITICAL wheel off");
  CHECK(robot.go_home() == "nack out_of_use");
  CHECK(robot.mend("carry") == "nack conflict");
  CHECK(robot.mend("fly") == "nack bad_value");
  robot.out.clear();
  CHECK(robot.mend("mobile") == "ack in_use");
  CHECK(robot.over() == Texts{"mobile: repaired, says ann"});
  CHECK(robot.kept.empty());
  CHECK(robot.mend() == "nack conflict");
  robot.tell("heat", 80);
  const auto refused = robot.deliver(MessageType::command, TakeIntoUse{"", false, "ann"});
  CHECK(robot.nack_of(refused).code == "conflict");
  CHECK(robot.nack_of(refused).what.find("it still says \"heat: heat is 80\"") != std::string::npos);
  CHECK(robot.kept.size() == 1);
  robot.down(Channel::field);  // switched off, it sends nothing
  CHECK(robot.mend() == "ack in_use");
  robot.up(Channel::field);
  robot.wait(20);
  robot.tell("heat", 80);  // and was not repaired
  CHECK(robot.kept.size() == 1);
}

TEST_CASE("in fields a robot may take its word back") {
  Robot robot;
  robot.fault("mobile CRITICAL wheel off");
  robot.fault("carry FATAL arm off");
  robot.out.clear();
  robot.fault("mobile OVER");
  CHECK(robot.over() == Texts{"mobile: wheel off"});
  CHECK(robot.kept.size() == 1);
  robot.fault("carry WARNING arm stiff");  // it has become milder
  CHECK(robot.kept.empty());
}

TEST_CASE("retired is a person's word, and return another one; what runs goes on") {
  Robot robot;
  CHECK(robot.give_back() == "nack conflict");
  CHECK(robot.go_home() == "running");
  robot.out.clear();
  CHECK(robot.retire() == "ack out_of_use");
  CHECK(robot.told<Outcome>().empty());
  CHECK(robot.one<NodeProfile>().out_of_use.at(0).retired);
  CHECK(robot.retire("bob") == "ack out_of_use");
  REQUIRE(robot.kept.size() == 1);
  CHECK(robot.kept[0].what.by == "bob");
  CHECK(robot.mend() == "nack conflict");
  robot.take_fields();
  robot.fault("mobile WARNING squeaks");
  CHECK(robot.give_back() == "ack in_use");
  CHECK(robot.kept.empty());
}

TEST_CASE("only the node's own services tell a fault, a retirement is of the whole robot, and somebody is named") {
  Robot robot;
  const auto take = [&](OutOfUse what, const std::string& source) {
    return robot.answer(robot.deliver(MessageType::command, TakeOutOfUse{std::move(what)}, source));
  };
  CHECK(take({"", Severity::critical, "lost", 0, false, "scheduler"}, "cloud") == "nack not_permitted");
  CHECK(take({"mobile", Severity::critical, "", 0, true, "ann"}, "cloud") == "nack bad_value");
  CHECK(take({"fly", Severity::critical, "", 0, false, "scheduler"}, "pioneer") == "nack bad_value");
  CHECK(take({"", Severity::critical, "", 0, true, ""}, "cloud") == "nack missing");
  CHECK(robot.kept.empty());
  CHECK(take({"", {}, "its journal was lost", 0, false, ""}, "pioneer") == "ack out_of_use");
  CHECK(robot.kept.at(0).what.severity == Severity::critical);
  for (int i = 0; i < 300; ++i) take({"", Severity::fatal, "lost", 0, false, "s" + std::to_string(i)}, "pioneer");
  CHECK(robot.kept.size() == 1);  // one line per capability, whoever reports it
  CHECK(robot.go_home() == "nack out_of_use");
  CHECK(robot.mend() == "ack in_use");
  CHECK(robot.go_home() == "running");
}

TEST_CASE("a disk that takes nothing: the fault holds, is told, and is written as soon as there is room") {
  Robot robot;
  robot.kept_status = fail(Errc::io_error, "No space left on device");
  robot.out.clear();
  robot.tell("heat", 80);
  CHECK(robot.one<NodeProfile>().out_of_use.size() == 1);
  CHECK(robot.go_home() == "nack out_of_use");
  CHECK(robot.retire() == "nack io_error");
  CHECK(robot.retire() == "nack io_error");  // said again, it still is not on disk
  CHECK(robot.give_back() == "nack io_error");
  CHECK(robot.kept.empty());
  robot.kept_status = Done{};
  robot.wait(1.1);
  CHECK(robot.kept.size() == 2);
  CHECK(robot.give_back() == "ack in_use");
}

TEST_CASE("the same in other words is written once a second, and at once if it is worse") {
  Robot robot;
  const int before = robot.kept_writes;
  for (int i = 0; i < 20; ++i) robot.fault("mobile CRITICAL wheel " + std::to_string(i));
  CHECK(robot.kept_writes == before + 1);
  robot.wait(1.1);
  CHECK(robot.kept_writes == before + 2);
  CHECK(robot.kept.at(0).what.text == "wheel 19");
  robot.fault("mobile FATAL wheel lost");
  CHECK(robot.kept_writes == before + 3);
}

TEST_CASE("a capability that the robot has not is told to the fleet and keeps nothing out of use") {
  Robot robot;
  for (int i = 0; i < 300; ++i) robot.fault("c" + std::to_string(i) + " CRITICAL x");
  CHECK(robot.kept.empty());
  CHECK(robot.told<RobotFault>().size() == 300);
}

TEST_CASE("the skills and the numbers of the description are told") {
  Settings settings = pioneer();
  settings.description.skills[0].repeatable = true;
  settings.description.numbers = {{"payload", 3, "kg"}};
  Robot robot(settings);
  CHECK(robot.one<AdapterState>().skills ==
        std::vector<SkillUse>{{"go_to", "mobile", true}, {"home", "mobile", false}});
  CHECK(robot.one<NodeProfile>().numbers == settings.description.numbers);
}

TEST_CASE("the file: what was kept is read again, and one that is broken keeps the robot out of use") {
  const TemporaryFolder folder;
  std::filesystem::create_directories(folder.path + "/state");
  const OutOfUseFile file(folder.path);
  CHECK(file.read().empty());
  const std::vector<Kept> lines = {
      {"rule heat", {"mobile", Severity::fatal, "\"hot\"\n", 1'795'000'000'000'000'123, false, ""}},
      {"retired", {"", Severity::critical, "sold", 7, true, "ann"}}};
  REQUIRE(file.save(lines));
  const auto read = file.read();
  REQUIRE(read.size() == 2);
  CHECK(read[0].cause == "rule heat");
  CHECK(read[0].what == lines[0].what);
  CHECK(read[1].what == lines[1].what);
  for (const char* broken : {"", "{}", "{\"out_of_use\":[{}]}", "{\"out_of_use\":[{\"cause\":\"\"}]}"}) {
    REQUIRE(write_file(folder.path + "/state/out_of_use.json", broken));
    REQUIRE(file.read().size() == 1);
    CHECK(file.read()[0].what.capability.empty());
  }
  std::filesystem::remove_all(folder.path);
  CHECK_FALSE(OutOfUseFile(folder.path).save(lines));
}
