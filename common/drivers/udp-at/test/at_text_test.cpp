// AT commands and navdata, byte by byte.
#include "common/drivers/udp-at/at_text.hpp"

#include "common/drivers/udp-at/test/fixture.hpp"
#include "common/drivers/udp-at/values.hpp"

using namespace trb;
using namespace trb::adapter;

namespace {

/// The command as sent with sequence number 7, or the error's code.
std::string line_of(const std::string& words, const std::string& data) {
  const auto lines = read_at_lines(words);
  REQUIRE_MESSAGE(lines.ok(), words);
  const auto orders = fill_at_lines(*lines, data);
  if (!orders) return std::string(errc_name(orders.error().code));
  return at_line(orders->front().name, 7, orders->front().arguments);
}

std::string bytes_of(const std::string& hex) {
  std::string out;
  for (std::size_t i = 0; i < hex.size(); i += 2) out += static_cast<char>(std::stoi(hex.substr(i, 2), nullptr, 16));
  return out;
}

// Hovering, 76 %, theta -1000, phi 2000, psi 90000 thousandths of a degree, 812 mm, 120 and -30 mm/s; made by an
// independent program (python3, struct).
const std::string kGolden = bytes_of(
    "8877665511040000e80300000000000000009400000004004c00000000007ac40000fa4400c8af472c0300000000f0420000f0c1" +
    std::string(224, '0') + "ffff0800ea0a0000");

}  // namespace

TEST_CASE("AT: floats are sent as the int32 of the same bits, texts in quotes, whole numbers as they are") {
  CHECK(line_of("LED {0} {1} {2}", "[3, 0.5, 2]") == "AT*LED=7,3,1056964608,2\r");
  CHECK(line_of("LED 3 2 {data}", "5") == "AT*LED=7,3,1073741824,5\r");
  CHECK(line_of("PCMD {0} {1} {2} {3}", "0 -0.8 0.05 1") == "AT*PCMD=7,0,-1085485875,1028443341,1065353216\r");
  CHECK(line_of("ANIM {0} {1}", "[16, 1000]") == "AT*ANIM=7,16,1000\r");
  CHECK(line_of("FTRIM", "") == "AT*FTRIM=7\r");
  CHECK(line_of("CONFIG \"control:altitude_max\" {data}", "3000") == "AT*CONFIG=7,\"control:altitude_max\",\"3000\"\r");
  CHECK(line_of("CONFIG \"general:navdata_demo\" {data}", "true") == "AT*CONFIG=7,\"general:navdata_demo\",\"TRUE\"\r");
  CHECK(line_of("CONFIG {0} {1}", R"(["control:flight_anim", "18,15"])") ==
        "AT*CONFIG=7,\"control:flight_anim\",\"18,15\"\r");
}

TEST_CASE("AT: the protocol has no escape, so that a quote or a line's end is refused in every text") {
  for (const char* text :
       {R"("a\"b")", R"("a\nb")", R"("a\rAT*REF=9,290717952\r")", R"("gr\u00fcn")", R"("a\u0000b")"}) {
    CAPTURE(text);
    CHECK(line_of("CONFIG \"general:ardrone_name\" {data}", text) == "not_escapable");
    CHECK(line_of("CONFIG {0} {1}", std::string("[\"a\",") + text + "]") == "not_escapable");
    CHECK(line_of("CONFIG {0} {1}", std::string("[") + text + ",\"a\"]") == "not_escapable");
  }
  CHECK(line_of("CONFIG \"k\" {data}", "plain \"words\"\n") == "not_escapable");
}

TEST_CASE("AT: data that does not fit is refused") {
  CHECK(line_of("PCMD {0} {1} {2} {3}", "[0, 1.5, 0, 0]") == "bad_value");
  CHECK(line_of("PCMD {0} {1} {2} {3}", "[0, 1]") == "bad_value");
  CHECK(line_of("PCMD {0} {1} {2} {3}", R"([0, "1", 0, 0])") == "bad_value");
  CHECK(line_of("ANIM {0} {1}", "[1.5, 2]") == "bad_value");
  CHECK(line_of("ANIM {0} {1}", "[1, 5000000000]") == "bad_value");
  CHECK(line_of("hover for {data}", "-1") == "bad_value");
  CHECK(line_of("hover for {data}", "") == "bad_value");
  CHECK(line_of("CONFIG \"k\" {data}", "[1]") == "bad_value");
  CHECK(line_of("CONFIG \"k\" {data}", '"' + std::string(600, 'x') + '"') == "bad_value");
}

TEST_CASE("navdata: a golden packet, in SI units and the axes forward, left, up") {
  REQUIRE(kGolden.size() == 172);
  CHECK(kGolden == [] {
    Sky sky{.control = 4, .flying = true, .bits = (1U << 4) | (1U << 10)};
    sky.vx = 120;
    sky.vy = -30;
    return navdata(1000, sky);
  }());
  const auto read = read_ar_navdata(kGolden);
  REQUIRE(read.ok());
  CHECK(read->sequence == 1000);
  CHECK(read->airborne());
  CHECK(read->demo->battery == 76);
  CHECK(read->demo->altitude == doctest::Approx(0.812));
  CHECK(read->demo->yaw == doctest::Approx(-1.5707963));
  CHECK(read->demo->roll == doctest::Approx(0.0349066));
  CHECK(read->demo->pitch == doctest::Approx(0.0174533));
  CHECK(read->demo->vx == doctest::Approx(0.12));
  CHECK(read->demo->vy == doctest::Approx(0.03));
}

TEST_CASE("navdata: any byte that has changed is noticed, and so is any end that is missing") {
  for (std::size_t i = 0; i < kGolden.size(); ++i) {
    CAPTURE(i);
    std::string changed = kGolden;
    changed[i] = static_cast<char>(changed[i] ^ 0x20);
    CHECK_FALSE(read_ar_navdata(changed).ok());
    CHECK_FALSE(read_ar_navdata(kGolden.substr(0, i)).ok());
  }
  std::string changed = kGolden;
  changed[30] = 'x';
  CHECK(read_ar_navdata(changed).error().code == Errc::bad_signature);
  CHECK(read_ar_navdata(kGolden + "x").error().code == Errc::malformed);
}

TEST_CASE("navdata: numbers that are none, and a checksum without options") {
  std::string no_speed = kGolden.substr(0, 164);
  no_speed.replace(16 + 28, 4, little_float(std::numeric_limits<float>::quiet_NaN()));
  CHECK(read_ar_navdata(with_checksum(no_speed)).error().code == Errc::malformed);
  std::string full = kGolden.substr(0, 164);
  full.replace(16 + 8, 4, little_endian(101, 4));
  CHECK(read_ar_navdata(with_checksum(full)).error().code == Errc::malformed);
  CHECK(read_ar_navdata(navdata(3, {.demo = false}))->demo == std::nullopt);
}

TEST_CASE("navdata: every name that commands.json may use has a value") {
  std::vector<std::string> told;
  for (const ArValue& value : ar_values(*read_ar_navdata(kGolden))) told.push_back(value.name);
  std::vector<std::string> known = at_value_names();
  std::ranges::sort(told);
  std::ranges::sort(known);
  CHECK(told == known);
}
