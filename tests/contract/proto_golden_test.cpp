// The bytes on the wire, written down. A field that is moved, removed or changes its type fails here.
#include <doctest/doctest.h>

#include <tuple>

#include "common/base/hex.hpp"
#include "proto/body.hpp"
#include "proto/figure3.hpp"
#include "proto/message.hpp"

using namespace trb;

namespace {

const SignedRecord kRecord{"result", "ur3", {"p"}, {"s"}};
constexpr const char* kRecordHex = "94a6726573756c74a3757233c40170c40173";

Message golden_example() {
  return {.type = MessageType::request,
          .flags = kFlagNoAnswer,
          .remaining_ms = 500,
          .subtype = "move",
          .source = "ur3",
          .target = "pioneer",
          .id = 0x0002000000000007,
          .reply_to = 1,
          .data = "1 2"};
}

}  // namespace

TEST_CASE("the frame of a message: 24 bytes of prefix, six header fields, the data") {
  Bytes frame = encode_frame(golden_example());
  CHECK(to_hex(frame) ==
        "02020001000001f400000000000000000000000000000000"  // version type flags remaining link sequence
        "96a46d6f7665a3757233a770696f6e656572cf00020000000000070103"
        "312032");
  stamp_link(frame.data(), 0x0102030405060708, 9, 499);
  CHECK(to_hex(frame.substr(0, kPrefixSize)) == "02020001000001f301020304050607080000000000000009");
  CHECK(decode_frame(frame)->sequence == 9);
  CHECK(to_message(*decode_frame(encode_frame(golden_example()))) == golden_example());
}

TEST_CASE("the datagram of Figure 3: 32 bytes of header, the data") {
  Message message = golden_example();
  message.flags = 0;
  CHECK(to_hex(*to_figure3(message)) ==
        "00000002"
        "6d6f766500000000"
        "7572330000000000"
        "70696f6e65657200"
        "00000003"
        "312032");
}

TEST_CASE("a node's profile") {
  const NodeProfile profile{"ur",
                            "direct",
                            "tcp-text",
                            "UR",
                            "UR3",
                            {"grab"},
                            {"t1"},
                            {{"go_to", "mobile", {{"place", "place", true, "m", {-1, 2.5}, {"a"}, 6}}, true, 2.5}},
                            {"a"},
                            "ONLINE",
                            "d",
                            true,
                            "cloud",
                            {{"t1", "temperature", "degC", "7", "d", SensorState::ok, ""}},
                            {1, 2.5, 0, -1},
                            {{"grab", Severity::fatal, "t", 5, false, "b"}},
                            {{"payload", 3, "kg"}},
                            {{DrivePart::tool, {"x"}, {2.5}}}};
  CHECK(to_hex(encode(profile)) ==
        "dc0012"
        "a27572"
        "a6646972656374"
        "a87463702d74657874"
        "a25552"
        "a3555233"
        "91a467726162"
        "91a27431"
        "9195"
        "a5676f5f746f"
        "a66d6f62696c65"
        "9197a5706c616365a5706c616365c3a16d"
        "92cbbff0000000000000cb4004000000000000"
        "91a161"
        "06"
        "c3"
        "cb4004000000000000"
        "91a161"
        "a64f4e4c494e45"
        "a164"
        "c3"
        "a5636c6f7564"
        "9197a27431ab74656d7065726174757265a464656743a137a16401a0"
        "94cb3ff0000000000000cb4004000000000000cb0000000000000000cbbff0000000000000"
        "9196a46772616203a17405c2a162"
        "9193a77061796c6f6164cb4008000000000000a26b67"
        "91930291a17891cb4004000000000000");
}

TEST_CASE("the start of a run") {
  RunStart start{"r", {"d"}, {"s", "t", {}}, {2, {"ur3"}}, {{"ur3", kRecord}}, {"ur3"}, "cloud", 5, -6};
  start.scenario.tasks.push_back({"a", "ur3", {"grab"}, "go_to", "{}", {0, 300}, 1.0, true, {}});
  start.scenario.tasks[0].when = {{"t", "c", "7", Comparison::at_most, false, 20, "", "degC"}};
  CHECK(to_hex(encode(start)) ==
        std::string("9a"
                    "a172"
                    "c40164"
                    "93a173a174"
                    "919e"
                    "a161"
                    "a3757233"
                    "91a467726162"
                    "a5676f5f746f"
                    "a27b7d"
                    "9200cd012c"
                    "cb3ff0000000000000"
                    "c3"
                    "9198a174a163a13701c2cb4034000000000000a0a46465674300cb3ff00000000000000090cb0000000000000000"
                    "9202"
                    "91a3757233"
                    "9192a3757233") +
            kRecordHex +
            "91a3757233"
            "a5636c6f7564"
            "05"
            "fa"
            "00");
}

TEST_CASE("a baton and a task's result") {
  CHECK(to_hex(encode(Baton{"r", {"d"}, 3, {"\x05"}, {kRecord}, {1, 2}, {kRecord}, {"\x04"}, {kRecord}, {"\x07"}})) ==
        std::string("9aa172c4016403c4010591") + kRecordHex + "92010291" + kRecordHex + "c4010491" + kRecordHex +
            "c40107");
  CHECK(to_hex(encode(Results{"r", {}, {kRecord}, {"\x07"}})) == std::string("94a1729091") + kRecordHex + "c40107");
  const TaskResult result{{"r", "t", 1, 2}, {"d"}, 3, "ur3", TaskOutcome::failed, "why", "7", 10, 20, -0.0, true};
  CHECK(to_hex(encode(result)) ==
        "9b"
        "94a172a1740102"
        "c40164"
        "03"
        "a3757233"
        "02"
        "a3776879"
        "a137"
        "0a"
        "14"
        "cb8000000000000000"
        "c3");
}

TEST_CASE("a choice keeps the reading that decided") {
  const SensorReading reading{"t", "7", "degC", false, 25.5, "", 5, 0, "good", 0, 0};
  CHECK(to_hex(encode(Choice{"r", {"d"}, 1, "ur3", {{"left", 1, false}, {"right", 1, true}}, "belt", reading, 6})) ==
        "98a172c4016401a3757233"
        "9293a46c65667401c293a5726967687401c3"
        "a462656c74"
        "9ba174a137a464656743c2cb4039800000000000a005cb0000000000000000a4676f6f640000"
        "06");
}

TEST_CASE("a decision says what becomes of each task, and by what right") {
  const Decision decision{
      "r", {"d"}, 2,     {"p"}, "cloud", {{"go", Ruling::move, "p1", 2, Evidence::word}}, {{"p1", kRecord}},
      "a", "Ann", "why", 7};
  CHECK(to_hex(encode(decision)) == std::string("9ba172c4016402c40170a5636c6f7564"
                                                "9195a2676f00a270310201"
                                                "9192a27031") +
                                        kRecordHex + "a161a3416e6ea3776879" + "07");
  CHECK(to_hex(encode(RunDecision{kRecord})) == std::string("91") + kRecordHex);
  CHECK(to_hex(encode(DecisionJournaled{"r", 3})) == "92a17203");
  CHECK(to_hex(encode(ReleaseTasks{"r", 1, {3, 6}})) == "94a17201920306c2");
  CHECK_FALSE(decode<ReleaseTasks>(*from_hex("93a17201920306"))->stop);  // as it was before there was a stop
  CHECK(to_hex(encode(PauseOrder{"r", 2, true, "cloud", "why", 7, {"go"}})) ==
        "97a17202c3a5636c6f7564a37768790791a2676f");
  CHECK(to_hex(encode(RunEnd{"r", {"d"}, "cloud", RunState::finished, 7})) == "95a172c40164a5636c6f75640307");
}

TEST_CASE("alerts and what is decided on them") {
  const Proposal proposal{"p1", {{"go", "p1"}}, 0.5, {{"battery", 80, "%", 0.25, 0.125, "p1"}}, "n", 0.5};
  Alert alert;
  std::tie(alert.id, alert.run, alert.name, alert.robot, alert.capability) = std::tuple("a", "r", "n", "ur3", "grab");
  std::tie(alert.severity, alert.cause, alert.text, alert.time) = std::tuple(Severity::fatal, "robot_fault", "t", 7);
  alert.tasks = {"go"};
  alert.proposals = {proposal};
  CHECK(to_hex(encode(alert)) ==
        "dc0015a161a172a16ea3757233a46772616203ab726f626f745f6661756c74a17491a2676f070000"
        "91"
        "96a2703191"
        "92a2676fa27031"
        "cb3fe0000000000000"
        "9196a762617474657279cb4054000000000000a125cb3fd0000000000000cb3fc0000000000000a27031"
        "a16e"
        "cb3fe0000000000000"
        "90a0c200a0a000a0");
  CHECK(to_hex(encode(AlertDecide{"a", Verdict::override_, "p1", "Ann", "why", true, "r", {"go"}})) ==
        "99a16102a27031a3416e6ea3776879c3a17291a2676f90");
  CHECK(to_hex(encode(AlertDecide{"a", Verdict::accept, "", "Ann", "", false, "", {}, {{"go", "p1"}}})) ==
        "99a16101a0a3416e6ea0c2a090"
        "9192a2676fa27031");
  CHECK(to_hex(encode(DecidedElsewhere{"c", "r", {"go"}})) == "93a163a17291a2676f");
  CHECK(to_hex(encode(AlertListRequest{true})) == "91c3");
  CHECK(to_hex(encode(AlertRankRequest{"a", {{"b", 1}}})) == "92a1619192a162cb3ff0000000000000");
  CHECK(to_hex(encode(AlertRanking{"a", {}, {}, {}, {{"b", 0.5, "r"}}, true})) ==
        "96a161909090"
        "9193a162cb3fe0000000000000a172"
        "c3");
  CHECK(to_hex(encode(HistoryListRequest{"ur3", 7})) == "92a375723307");
  CHECK(to_hex(encode(HistoryTable{{{9, "ur3", "fault", "x"}}})) == "91919409a3757233a56661756c74a178");
  CHECK(to_hex(encode(RunWatch{10})) == "91cb4024000000000000");
}

TEST_CASE("bodies of link and bus") {
  CHECK(to_hex(encode(KeepAlive{300})) == "91cd012c");
  CHECK(to_hex(encode(ServiceCountersRequest{"s"})) == "91a173");
  CHECK(to_hex(encode(Counters{"n", "s", {{"late.baton", 2}}})) ==
        "93a16ea173"
        "9192aa6c6174652e6261746f6e02");
  CHECK(to_hex(encode(Goodbye{"x"})) == "91a178");
  CHECK(to_hex(encode(RevokedNodes{{{"n", 5}}})) == "919192a16e05");
  CHECK(to_hex(encode(HelloWanted{})) == "90");
  CHECK(to_hex(encode(ServiceHello{"s", {"a"}, 1, 2, "v", {"h"}, "w"})) == "97a17391a1610102a17691a168a177");
  CHECK(to_hex(encode(ServiceWelcome{"n", "robot", 3, 4, 5})) == "95a16ea5726f626f74030405");
  CHECK(to_hex(encode(Hello{kRecord, 1, "h:1", "v", 2, false, {}, 3, "s", true, "l"})) ==
        std::string("9b") + kRecordHex +
            "01a3683a31a17602c2"
            "dc0012a0a0a0a0a090909090a0a0c2a090"
            "94cb0000000000000000cb0000000000000000cb0000000000000000cb0000000000000000"
            "909090"
            "03a173c3a16c");
  CHECK(to_hex(encode(Beacon{kRecord, "h:1", 1, 2, 3})) == std::string("95") + kRecordHex + "a3683a31010203");
  CHECK(to_hex(encode(InjectFault{"grab", Severity::fatal, "t"})) == "93a46772616203a174");
  CHECK(to_hex(encode(Velocity{DrivePart::joints, {2.5}, 300, 7, false, true, "p"})) ==
        "970191cb4004000000000000cd012c07c2c3a170");
  CHECK(to_hex(encode(RobotState{{{"safety", "3"}}})) == "919192a6736166657479a133");
  CHECK(to_hex(encode(SensorRead{"t", "7", 2})) == "93a174a137cb4000000000000000");
  CHECK(to_hex(encode(SensorReading{"t", "7", "m", false, 2, "", 5, 2, "good", 3, 4})) ==
        "9ba174a137a16dc2cb4000000000000000a005cb4000000000000000a4676f6f640304");
  CHECK(to_hex(encode(SensorWatch{"t", "7", 3, 2, 2})) == "95a174a13703cb4000000000000000cb4000000000000000");
  CHECK(to_hex(encode(SensorImage{"c", "7", "m", 5, Blob{"x"}})) == "95a163a137a16d05c40178");
  CHECK(to_hex(encode(Nack{"c", "s", "t", "w", "u", "r"})) == "96a163a173a174a177a175a172");
  const auto before = decode<Nack>(*from_hex("95a163a173a174a177a175"));
  REQUIRE(before.ok());
  CHECK((before->hint == "u" && before->about.empty()));
}

TEST_CASE("bodies of an invitation") {
  CHECK(to_hex(encode(Invitation{{"f"}, "arm", Role::cloud, {"k"}, 5})) == "95c40166a361726d01c4016b05");
  CHECK(to_hex(encode(HoldInvitation{kRecord, 2, {"o"}, true})) == std::string("94") + kRecordHex + "02c4016fc3");
  CHECK(to_hex(encode(InvitationState{2, {{{"w"}}}})) == "92029191c40177");
  CHECK(to_hex(encode(JoinCall{{"w"}})) == "91c40177");
  CHECK(to_hex(encode(JoinAnswer{{"o"}})) == "91c4016f");
  CHECK(to_hex(encode(JoinWord{kRecord, true})) == std::string("92") + kRecordHex + "c3");
  CHECK(to_hex(encode(
            JoinOffer{"a", Role::robot, "f", {"k"}, {"d"}, "r", kRecord, 3, {"b"}, kRecord, {{"h:1", {"s"}}}})) ==
        std::string("9ba16100a166c4016bc40164a172") + kRecordHex + "03c40162" + kRecordHex + "9192a3683a31c40173");
}

TEST_CASE("the JSON of a message, with text, with bytes, with a body") {
  Message message = golden_example();
  CHECK(
      message_to_json(message) ==
      R"({"type":"request","subtype":"move","source":"ur3","target":"pioneer","id":562949953421319,"reply_to":1,"size":3,"data":"1 2"})");
  message.data = "\xff";
  message.reply_to = 0;
  message.id = ~std::uint64_t{0};
  CHECK(
      message_to_json(message) ==
      R"({"type":"request","subtype":"move","source":"ur3","target":"pioneer","id":"18446744073709551615","size":1,"data_hex":"ff"})");
  message.subtype = "stop";
  message.data = encode(Stop{"now"});
  CHECK(
      message_to_json(message) ==
      R"({"type":"request","subtype":"stop","source":"ur3","target":"pioneer","id":"18446744073709551615","size":5,"body":{"reason":"now"}})");
  CHECK(to_json(RobotFault{"grab", Severity::fatal, "t"}) ==
        R"({"capability":"grab","severity":"FATAL","text":"t","ended":false})");
  CHECK(to_json(AbortOrder{"r", "b", "", -1}) == R"({"run":"r","by":"b","reason":"","time":-1})");
  CHECK(to_json(NeedDefinition{"r", {"\xab"}}) == R"({"run":"r","digest":"ab","compact":false,"reads_short":false})");
}
