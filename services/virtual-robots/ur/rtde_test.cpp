#include "services/virtual-robots/ur/rtde_session.hpp"

#include <doctest/doctest.h>

#include <cmath>

using namespace trb::virtual_robots::ur;

namespace {

std::string sent(char type, const std::string& body) {
  return Bytes().u16(static_cast<std::uint16_t>(3 + body.size())).u8(static_cast<std::uint8_t>(type)).text(body).str();
}

/** A session and what its client says and hears. */
struct RtdeFixture {
  std::string say(char type, const std::string& body) {
    std::string input = sent(type, body);
    return session.take(input, written, time);
  }
  std::string version(int number) { return say('V', Bytes().u16(static_cast<std::uint16_t>(number)).str()); }
  std::string outputs(double rate, const std::string& names) { return say('O', Bytes().f64(rate).text(names).str()); }

  RtdeClaims claims;
  RtdeSession session{7, claims};
  RtdeWritten written;
  double time = 100;
};

std::string types(const std::string& answer, std::size_t from) {
  return answer.substr(from);
}

}  // namespace

TEST_CASE("rtde: versions 1 and 2 are spoken, others are refused, and the controller's is told") {
  RtdeFixture fixture;
  CHECK(fixture.version(3) == std::string("\0\4V\0", 4));
  CHECK(fixture.version(2) == std::string("\0\4V\1", 4));
  CHECK(fixture.version(1) == std::string("\0\4V\1", 4));
  CHECK(fixture.say('v', "") == Bytes().u16(19).u8('v').u32(5).u32(12).u32(0).u32(0).str());
}

TEST_CASE("rtde: outputs have their types, and one that is not there makes the recipe invalid") {
  RtdeFixture fixture;
  fixture.version(2);
  const std::string good =
      fixture.outputs(125, "timestamp,actual_q,robot_mode,runtime_state,actual_digital_output_bits");
  CHECK(good[3] == 1);
  CHECK(types(good, 4) == "DOUBLE,VECTOR6D,INT32,UINT32,UINT64");
  const std::string bad = fixture.outputs(125, "timestamp,nonsense,actual_q");
  CHECK(bad[3] == 0);
  CHECK(types(bad, 4) == "DOUBLE,NOT_FOUND,VECTOR6D");
  CHECK(fixture.say('S', "") == std::string("\0\4S\0", 4));
  CHECK(fixture.outputs(125, "")[3] == 0);
  CHECK(fixture.outputs(125, std::string(RtdeSession::kLongestNames + 1, 'x'))[3] == 0);
  fixture.version(1);
  CHECK(types(fixture.say('O', "actual_q,x"), 3) == "VECTOR6D,NOT_FOUND");
}

TEST_CASE("rtde: data come at the rate that is asked for, and not while paused") {
  RtdeFixture fixture;
  fixture.version(2);
  fixture.outputs(10, "timestamp,actual_q");
  RtdePicture picture;
  picture.time = 2.5;
  picture.state.joints.position = {1, 2, 3, 4, 5, 6};
  CHECK(fixture.session.data(picture, 100).empty());
  CHECK(fixture.say('S', "") == std::string("\0\4S\1", 4));
  CHECK(fixture.session.data(picture, 100) ==
        sent('U', Bytes().u8(1).f64(2.5).f64(1).f64(2).f64(3).f64(4).f64(5).f64(6).str()));
  CHECK(fixture.session.data(picture, 100.09).empty());
  CHECK(fixture.session.next_due() == doctest::Approx(100.1));
  CHECK_FALSE(fixture.session.data(picture, 100.1).empty());
  CHECK_FALSE(fixture.session.data(picture, 200).empty());
  CHECK(fixture.session.data(picture, 200.05).empty());  // what was missed is not sent afterwards
  CHECK(fixture.say('P', "") == std::string("\0\4P\1", 4));
  CHECK_FALSE(fixture.session.next_due());
  fixture.version(1);
  fixture.say('O', "timestamp");
  fixture.say('S', "");
  CHECK(fixture.session.data(picture, 300) == sent('U', Bytes().f64(2.5).str()));
  CHECK(fixture.session.next_due() == doctest::Approx(300.002));
}

TEST_CASE("rtde: every output has as many bytes as its type says") {
  for (const char* name : {"timestamp",
                           "target_q",
                           "actual_qd",
                           "target_qd",
                           "actual_TCP_pose",
                           "actual_TCP_speed",
                           "elbow_position",
                           "joint_mode",
                           "robot_mode",
                           "safety_mode",
                           "safety_status",
                           "runtime_state",
                           "actual_digital_input_bits",
                           "speed_scaling",
                           "target_speed_fraction",
                           "tool_output_voltage",
                           "tool_output_mode",
                           "safety_status_bits",
                           "robot_status_bits",
                           "analog_io_types",
                           "output_int_register_3",
                           "output_double_register_47",
                           "output_bit_register_64",
                           "output_bit_registers0_to_31",
                           "input_bit_registers32_to_63",
                           "input_bit_register_127"}) {
    const auto output = rtde_output(name);
    CAPTURE(name);
    REQUIRE(output);
    Bytes bytes;
    output->put({}, output->index, bytes);
    CHECK(bytes.str().size() == size_of(output->type));
  }
  for (const char* name : {"output_int_register_48", "output_bit_register_63", "output_bit_register_128", "actual_Q",
                           "input_int_register_", "input_int_register_01", "input_double_register_-1", ""}) {
    CHECK_FALSE(rtde_output(name));
  }
}

TEST_CASE("rtde: inputs are claimed by one client, and free again when it leaves") {
  RtdeFixture fixture;
  RtdeSession* other = new RtdeSession(8, fixture.claims);
  RtdeWritten ignored;
  std::string claim = sent('I', "speed_slider_mask,speed_slider_fraction");
  CHECK(types(other->take(claim, ignored, 0), 3) == std::string("\1UINT32,DOUBLE"));
  CHECK(types(fixture.say('I', "input_int_register_0,speed_slider_mask,none"), 3) ==
        std::string("\0INT32,IN_USE,NOT_FOUND", 23));
  CHECK(fixture.claims.owner_of("input_int_register_0") == 0);  // a recipe that is refused claims nothing
  delete other;
  CHECK(types(fixture.say('I', "speed_slider_mask,speed_slider_fraction"), 3) == std::string("\1UINT32,DOUBLE"));
  CHECK(types(fixture.say('I', "input_int_register_0"), 3) == std::string("\2INT32"));
  CHECK(types(fixture.say('I', "input_int_register_0"), 3) == std::string("\0IN_USE", 7));
}

TEST_CASE("rtde: what is written reaches the controller, masked") {
  RtdeFixture fixture;
  fixture.version(2);
  fixture.say('I', "speed_slider_mask,speed_slider_fraction,standard_digital_output_mask,standard_digital_output");
  fixture.say('I', "input_double_register_24");
  Controller controller;
  controller.set_output(1, true);
  CHECK(fixture.say('U', Bytes().u8(1).u32(1).f64(0.4).u8(0b0110).u8(0b0101).str()).empty());
  CHECK(fixture.session.take_changes());
  apply(fixture.written, controller, 0);
  CHECK(controller.state(0).speed_fraction == 0.4);
  CHECK(controller.state(0).io.outputs == 0b0100);
  CHECK(fixture.say('U', Bytes().u8(2).f64(1.5).str()).empty());
  apply(fixture.written, controller, 0);
  CHECK(controller.input_registers().doubles[24] == 1.5);
  CHECK(fixture.say('U', Bytes().u8(1).u32(1).f64(std::nan("")).u8(0).u8(0).str()).empty());
  apply(fixture.written, controller, 0);
  CHECK(controller.state(0).speed_fraction == 0.4);
}

TEST_CASE("rtde: what is not of its form is answered by a text, and a border that is lost ends it") {
  RtdeFixture fixture;
  fixture.version(2);
  fixture.say('I', "input_int_register_0");
  for (const std::string& answer : {fixture.say('U', Bytes().u8(1).u8(0).str()), fixture.say('U', Bytes().u8(9).str()),
                                    fixture.say('U', ""), fixture.say('Q', ""), fixture.say('M', "\x05hi")}) {
    CHECK(answer[2] == 'M');
  }
  CHECK_FALSE(fixture.session.take_changes());
  CHECK(fixture.say('M', Bytes().u8(2).text("hi").u8(1).text("c").u8(3).str()).empty());
  CHECK(fixture.session.take_texts() == std::vector<std::string>{"hi"});
  std::string half = sent('v', "").substr(0, 2);
  CHECK(fixture.session.take(half, fixture.written, 0).empty());
  CHECK(half.size() == 2);
  std::string lost("\0\1v", 3);
  fixture.session.take(lost, fixture.written, 0);
  CHECK(fixture.session.broken());
}
