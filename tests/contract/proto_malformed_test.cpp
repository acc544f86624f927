// Untrusted input: every decoder refuses what is wrong, names the error, and never crashes.
#include <doctest/doctest.h>

#include <chrono>
#include <optional>

#include "proto/figure3.hpp"
#include "proto/message.hpp"
#include "proto/value.hpp"
#include "tests/contract/fill.hpp"

using namespace trb;
using namespace trb::contract;

namespace {

template <class T>
void check_refused(const Result<T>& result, Errc code) {
  REQUIRE_FALSE(result.ok());
  CHECK(errc_name(result.error().code) == errc_name(code));
  CHECK_FALSE(result.error().what.empty());
}

/// Calls read once for each single flipped bit of the bytes.
template <class Read>
void flip_each_bit(const Bytes& good, Read read) {
  for (std::size_t bit = 0; bit < good.size() * 8; ++bit) {
    Bytes bad = good;
    bad[bit / 8] = static_cast<char>(static_cast<unsigned char>(bad[bit / 8]) ^ (1U << (bit % 8)));
    read(bad);
  }
}

/// Calls read with every proper prefix of the bytes.
template <class Read>
void cut_everywhere(const Bytes& good, Read read) {
  for (std::size_t size = 0; size < good.size(); ++size) read(good.substr(0, size));
}

template <class Work>
std::chrono::nanoseconds time_of(const Work& work) {
  const auto begun = std::chrono::steady_clock::now();
  work();
  return std::chrono::steady_clock::now() - begun;
}

Message move_command() {
  return {
      .type = MessageType::command, .subtype = "move", .source = "ur3", .target = "pioneer", .id = 1, .data = "1 2"};
}

Bytes frame_with(const Bytes& header_and_data) {
  return encode_frame(move_command()).substr(0, kPrefixSize) + header_and_data;
}

}  // namespace

TEST_CASE("a body that is cut anywhere is refused; one with a bit changed is read or refused") {
  for (const AnyBody& is : every_body()) {
    CAPTURE(is.subtype);
    const Bytes good = is.encode(filled(is.kind));
    cut_everywhere(good, [&](const Bytes& bad) {
      const auto body = is.decode(bad);
      REQUIRE_FALSE(body.ok());
      CHECK(body.error().code != Errc::ok);
    });
    flip_each_bit(good, [&](const Bytes& bad) {
      const auto body = is.decode(bad);
      if (!body) CHECK_FALSE(body.error().what.empty());
    });
    check_refused(is.decode(good + '\0'), Errc::malformed);
    check_refused(is.decode("\x80"), Errc::malformed);
    check_refused(is.decode("\xc0"), Errc::malformed);
  }
}

TEST_CASE("a body's JSON that is cut anywhere is refused") {
  for (const AnyBody& is : every_body()) {
    CAPTURE(is.subtype);
    const std::string good = is.to_json(filled(is.kind));
    cut_everywhere(good, [&](const Bytes& bad) { CHECK_FALSE(is.from_json(bad).ok()); });
    check_refused(is.from_json(good + "x"), Errc::malformed);
    check_refused(is.from_json("[]"), Errc::malformed);
    check_refused(is.from_json(R"({"no_such_field":1})"), Errc::unknown_key);
  }
}

TEST_CASE("wrong types, sizes and values are told apart, and the field is named by its path") {
  check_refused(decode<Stop>(std::string("\x91\x01", 2)), Errc::malformed);
  check_refused(decode<Stop>("\x91\xa1\xff"), Errc::malformed);
  check_refused(decode<Stop>(std::string("\x91\xda\x01\x00", 4) + std::string(256, 'a')), Errc::too_large);
  check_refused(decode<KeepAlive>("\x91\xff"), Errc::malformed);
  check_refused(decode<RobotFault>(std::string("\x92\xa1x\x04", 4)), Errc::bad_value);
  ServiceHello many;
  many.subtypes.assign(65, "x");
  check_refused(decode<ServiceHello>(encode(many)), Errc::too_large);
  SignedRecord record;
  record.signature.bytes.assign(65, 's');
  check_refused(decode<SignedRecord>(encode(record)), Errc::too_large);
  Scenario scenario;
  scenario.tasks.resize(4);
  scenario.tasks[3].requires_.resize(33);
  CHECK(decode<Scenario>(encode(scenario)).error().what.find("tasks[3].requires") == 0);
  scenario.tasks[3].requires_.clear();
  scenario.tasks[3].id.assign(65, 'a');
  CHECK(from_json<Scenario>(to_json(scenario)).error().what.find("tasks[3].id") == 0);
}

TEST_CASE("numbers that are none are refused") {
  Outcome outcome;
  Bytes head = encode(outcome);
  head.resize(head.size() - 8);
  check_refused(decode<Outcome>(head + std::string("\x7f\xf8\0\0\0\0\0\0", 8)), Errc::bad_value);
  check_refused(decode<Outcome>(head + std::string("\x7f\xf0\0\0\0\0\0\0", 8)), Errc::bad_value);
  check_refused(from_json<Outcome>(R"({"duration_s":1e999})"), Errc::malformed);
  check_refused(from_json<Outcome>(R"({"duration_s":NaN})"), Errc::malformed);
  check_refused(from_json<KeepAlive>(R"({"heard":"99999999999999999999"})"), Errc::bad_value);
  check_refused(from_json<KeepAlive>(R"({"heard":"12x"})"), Errc::malformed);
  check_refused(from_json<KeepAlive>(R"({"heard":-1})"), Errc::bad_value);
  check_refused(from_json<RobotFault>(R"({"severity":"bad"})"), Errc::bad_value);
}

TEST_CASE("depth, declared lengths and sheer size are bounded") {
  const Bytes deep = Bytes(33, '\x91') + '\x90';
  check_refused(decode<Stop>(deep), Errc::too_large);
  check_refused(decode<Stop>(Bytes(300'000, '\x91')), Errc::too_large);
  check_refused(decode<Stop>("\xdd\xff\xff\xff\xff"), Errc::too_large);
  CHECK_FALSE(decode<Stop>("\x91\xdb\xff\xff\xff\xff").ok());
  check_refused(decode<Stop>(Bytes((1U << 20U) + 1, '\x90')), Errc::too_large);
  check_refused(parse_json(Bytes(33, '[') + Bytes(33, ']')), Errc::too_large);
  CHECK(parse_json(Bytes(32, '[') + Bytes(32, ']')).ok());
  check_refused(parse_json(Bytes(300'000, '[')), Errc::too_large);
  check_refused(parse_json(Bytes((1U << 20U) + 1, ' ')), Errc::too_large);
  check_refused(parse_json("\"\xff\""), Errc::malformed);
  check_refused(parse_json("\"\xed\xa0\x80\""), Errc::malformed);
  check_refused(parse_json(R"({"a":1,"a":2})"), Errc::duplicate);
  CHECK(parse_json(R"({"_comment":1,"_comment":2})").ok());
}

TEST_CASE("a large object of many keys is read without delay, and one value too many is refused") {
  std::string text = "{";
  for (int i = 0; i < 90'000; ++i) text += (i == 0 ? "\"" : ",\"") + std::to_string(i) + "\":0";
  CHECK(parse_json(text + "}").ok());
  for (int i = 90'000; i < 100'001; ++i) text += ",\"" + std::to_string(i) + "\":0";
  check_refused(parse_json(text + "}", {.bytes = 1U << 22U}), Errc::too_large);
}

TEST_CASE("an object of many keys is written about as fast as it is read, and comes back") {
  std::string text = "{";
  for (int i = 0; i < 90'000; ++i) text += (i == 0 ? "\"" : ",\"") + std::to_string(i) + "\":0";
  text += "}";
  std::optional<Value> value;
  const auto reading = time_of([&] { value = *parse_json(text); });
  std::string back;
  const auto writing = time_of([&] { back = dump_json(*value); });
  CHECK(back == text);
  // Writing that looks each key up among those before it takes a thousand times as long.
  CHECK(writing < 20 * reading);
}

TEST_CASE("a frame that is cut, changed or lies about itself is refused") {
  const Bytes good = encode_frame(move_command());
  REQUIRE(decode_frame(good).ok());
  cut_everywhere(good, [](const Bytes& bad) { CHECK_FALSE(decode_frame(bad).ok()); });
  flip_each_bit(good, [](const Bytes& bad) {
    const auto view = decode_frame(bad);
    if (!view) CHECK_FALSE(view.error().what.empty());
  });
  check_refused(decode_frame(good + "x"), Errc::malformed);
  Bytes bad = good;
  bad[0] = 1;
  check_refused(decode_frame(bad), Errc::version_mismatch);
  bad = good;
  bad[1] = 4;
  check_refused(decode_frame(bad), Errc::bad_value);
  check_refused(decode_frame(Bytes(kMaxFrameSize + 1, static_cast<char>(kWireVersion))), Errc::too_large);
  Message message = move_command();
  message.subtype = "no word";
  check_refused(decode_frame(encode_frame(message)), Errc::bad_value);
  message = move_command();
  message.target = "\xff";
  check_refused(decode_frame(encode_frame(message)), Errc::malformed);
  message.target = std::string(65, 'a');
  check_refused(decode_frame(encode_frame(message)), Errc::malformed);
  check_refused(decode_frame(frame_with("\x91\xa4move")), Errc::malformed);
  check_refused(decode_frame(frame_with(Bytes(300'000, '\x91'))), Errc::malformed);
  check_refused(decode_frame(frame_with("\xdd\xff\xff\xff\xff")), Errc::malformed);
  message = move_command();
  message.data.assign(kMaxDataSize + 1, 'x');
  check_refused(decode_frame(encode_frame(message)), Errc::too_large);
}

TEST_CASE("a message's JSON that lacks, doubles or contradicts something is refused") {
  const std::string good = message_to_json(move_command());
  cut_everywhere(good, [](const Bytes& bad) { CHECK_FALSE(message_from_json(bad).ok()); });
  flip_each_bit(good, [](const Bytes& bad) { (void)message_from_json(bad).ok(); });
  check_refused(message_from_json(R"({"subtype":"move"})"), Errc::missing);
  check_refused(message_from_json(R"({"type":"command"})"), Errc::missing);
  check_refused(message_from_json(R"({"type":"order","subtype":"move"})"), Errc::bad_value);
  check_refused(message_from_json(R"({"type":"command","subtype":"a b"})"), Errc::bad_value);
  check_refused(message_from_json(R"({"type":"command","subtype":"move","size":4,"data":"1"})"), Errc::bad_value);
  check_refused(message_from_json(R"({"type":"command","subtype":"move","data":"1","data_hex":"31"})"),
                Errc::bad_value);
  check_refused(message_from_json(R"({"type":"command","subtype":"stop","data":"1","body":{}})"), Errc::bad_value);
  check_refused(message_from_json(R"({"type":"command","subtype":"move","body":{}})"), Errc::unknown_subtype);
  check_refused(message_from_json(R"({"type":"command","subtype":"stop","body":{"reason":1}})"), Errc::malformed);
  check_refused(message_from_json(R"({"type":"command","subtype":"move","colour":1})"), Errc::unknown_key);
  check_refused(message_from_json("[]"), Errc::malformed);
}

TEST_CASE("a body of more values than are read again is shown as bytes") {
  Message message = move_command();
  message.type = MessageType::information;
  message.subtype = RouteTable::kSubtype;
  const auto table_of = [](std::size_t routes) {
    RouteTable table;
    table.routes.resize(routes);
    for (Route& route : table.routes) route.profile.sensors.resize(255);
    return encode(table);
  };
  message.data = table_of(500);
  REQUIRE(body_to_json(message.subtype, message.data).ok());
  const std::string json = message_to_json(message);
  CHECK(json.find("\"data_hex\"") != std::string::npos);
  CHECK(json.find("\"body\"") == std::string::npos);
  const auto back = message_from_json(json);
  REQUIRE(back.ok());
  CHECK(back->data == message.data);
  message.data = table_of(1);
  CHECK(message_to_json(message).find("\"body\"") != std::string::npos);
}

TEST_CASE("a datagram of Figure 3 that is cut, changed or lies about itself is refused") {
  const Bytes good = *to_figure3(move_command());
  cut_everywhere(good, [](const Bytes& bad) { check_refused(from_figure3(bad), Errc::malformed); });
  flip_each_bit(good, [](const Bytes& bad) { (void)from_figure3(bad).ok(); });
  check_refused(from_figure3(good + "x"), Errc::malformed);
  Bytes bad = good;
  bad[3] = 4;
  check_refused(from_figure3(bad), Errc::bad_value);
  bad = good;
  bad[10] = 'x';
  check_refused(from_figure3(bad), Errc::malformed);
  check_refused(from_figure3(good + Bytes(kMaxDataSize, 'x')), Errc::too_large);
  Message message = move_command();
  message.target = "too-long-a-name";
  check_refused(to_figure3(message), Errc::does_not_fit_figure_3);
}
