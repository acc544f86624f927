// What a client of the virtual Universal Robot's real-time data exchange sends: packages, recipes and inputs.
#include "services/virtual-robots/ur/rtde_session.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace virtual_robots::ur;

std::string package(char type, const std::string& body) {
  return virtual_robots::ur::Bytes()
      .u16(static_cast<std::uint16_t>(3 + body.size()))
      .u8(static_cast<std::uint8_t>(type))
      .text(body)
      .str();
}

void require_packages(std::string_view answers) {
  while (!answers.empty()) {
    Reader header(answers.substr(0, 3));
    const std::size_t size = header.u16();
    require(size >= 3 && size <= answers.size(), "answers are whole packages");
    answers.remove_prefix(size);
  }
}

struct Played {
  std::string answers;
  bool broken = false;
};

Played play(BytesView input, std::size_t piece) {
  RtdeClaims claims;
  RtdeSession session(1, claims);
  RtdeWritten written;
  Controller controller;
  Played out;
  std::string waiting;
  for (std::size_t at = 0; at < input.size() && !session.broken(); at += piece) {
    waiting += input.substr(at, piece);
    out.answers += session.take(waiting, written, 0);
    if (session.take_changes()) apply(written, controller, 0);
  }
  out.broken = session.broken();
  const RtdePicture picture{controller.state(1), 1, controller.input_registers(), controller.output_registers()};
  require_packages(session.data(picture, 1));
  const double fraction = picture.state.speed_fraction;
  require(fraction >= 0 && fraction <= 1, "the slider is between its ends");
  return out;
}

}  // namespace

std::vector<trb::Bytes> seeds() {
  const std::string two = package('V', std::string("\0\2", 2));
  const std::string rate = virtual_robots::ur::Bytes().f64(125).str();
  return {two + package('v', "") + package('O', rate + "timestamp,actual_q,output_int_register_3") + package('S', ""),
          package('O', "actual_q,none") + package('S', "") + package('P', ""),
          two + package('I', "speed_slider_mask,speed_slider_fraction") +
              package('U', virtual_robots::ur::Bytes().u8(1).u32(1).f64(0.5).str()),
          package('I', "input_bit_register_64,input_double_register_0,standard_analog_output_1") +
              package('U', virtual_robots::ur::Bytes().u8(1).u8(1).f64(3).f64(4).str()),
          two + package('M', "\x05hello\x02me\x03"),
          std::string("\0\1v", 3)};
}

void run(BytesView input) {
  const Played whole = play(input, input.size() + 1);
  const Played pieces = play(input, 1);
  require(whole.broken == pieces.broken, "where the stream breaks does not depend on how it is cut");
  require(whole.answers == pieces.answers, "what is answered does not depend on how it is cut");
  require_packages(whole.answers);
}

}  // namespace trb::fuzz
