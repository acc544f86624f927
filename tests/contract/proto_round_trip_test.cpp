// Every body is converted to msgpack and JSON and back unchanged; nodes of neighbouring versions understand each other.
#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "common/base/files.hpp"
#include "proto/message.hpp"
#include "proto/travel.hpp"
#include "proto/value.hpp"
#include "tests/contract/fill.hpp"
#include "tests/support/paths.hpp"

using namespace trb;
using namespace trb::contract;

TEST_CASE("every body goes through msgpack and JSON and comes back as it was") {
  for (const AnyBody& is : every_body()) {
    CAPTURE(is.subtype);
    const Body body = filled(is.kind);
    const auto packed = is.decode(is.encode(body));
    REQUIRE(packed.ok());
    CHECK(same(*packed, body));
    const auto text = is.from_json(is.to_json(body));
    REQUIRE(text.ok());
    CHECK(same(*text, body));
  }
}

TEST_CASE("every body goes by its subtype, as msgpack, as JSON and inside a message's JSON") {
  for (const AnyBody& is : every_body()) {
    CAPTURE(is.subtype);
    const Bytes data = is.encode(filled(is.kind));
    const auto body = decode_body(is.subtype, data);
    REQUIRE(body.ok());
    CHECK(subtype_of(*body) == is.subtype);
    CHECK(encode_body(*body) == data);
    CHECK(*body_from_json(is.subtype, *body_to_json(is.subtype, data)) == data);
    Message message;
    message.type = MessageType::information;
    message.subtype = is.subtype;
    message.data = data;
    const auto back = message_from_json(message_to_json(message));
    REQUIRE(back.ok());
    CHECK(*back == message);
  }
}

TEST_CASE("an older node's shorter array is filled with defaults, a newer one's tail is ignored") {
  for (const AnyBody& is : every_body()) {
    CAPTURE(is.subtype);
    const auto nothing = is.decode(std::string("\x90", 1));
    REQUIRE(nothing.ok());
    CHECK(same(*nothing, Body::of(is.kind)));
    const Body body = filled(is.kind);
    Bytes longer = is.encode(body);
    const auto first = static_cast<unsigned char>(longer[0]);
    const bool is_long = first == 0xdcU;  // over 15 fields: the number is in the two bytes behind
    REQUIRE((is_long || (first & 0xf0U) == 0x90U));
    const auto fields = is_long ? static_cast<unsigned char>(longer[2]) : first & 15U;
    if (!is_long && fields + 2 > 15) continue;
    longer[is_long ? 2 : 0] = static_cast<char>(is_long ? fields + 2 : 0x90U + fields + 2);
    longer += std::string("\xa3new\x92\x01\xc0", 7);
    const auto newer = is.decode(longer);
    REQUIRE(newer.ok());
    CHECK(same(*newer, body));
  }
}

TEST_CASE("an integer is taken for a double, and a double keeps its fraction and its sign") {
  Outcome outcome;
  for (const double value : {1.0, -0.0, 0.1, -3.0, 1e300}) {
    outcome.duration_s = value;
    const auto packed = decode<Outcome>(encode(outcome));
    const auto text = from_json<Outcome>(to_json(outcome));
    CHECK(packed->duration_s == value);
    CHECK(std::signbit(packed->duration_s) == std::signbit(value));
    CHECK(text->duration_s == value);
    CHECK(std::signbit(text->duration_s) == std::signbit(value));
  }
  Bytes integer = encode(Outcome{});
  integer.resize(integer.size() - 9);
  CHECK(decode<Outcome>(integer + '\x07')->duration_s == 7.0);
  CHECK(decode<Outcome>(integer + '\xfe')->duration_s == -2.0);
  CHECK(from_json<Outcome>(R"({"duration_s":7})")->duration_s == 7.0);
}

TEST_CASE("every typed subtype says how it travels: what is sent has a phase, a record needs none") {
  // Stored in files and inside signed records, never the subtype of a message.
  const std::vector<std::string_view> kept = {
      "certificate", "certificate_request", "scenario", "run_start", "revocation_list", "sealed_range", "relayed_frame",
      "result",      "abort_order",         "choice",   "decision",  "pause_order",     "alert",        "run_end",
      "invitation",  "join_offer",          "join_word"};
  for (const AnyBody& is : every_body()) {
    CAPTURE(is.subtype);
    const bool stays = std::find(kept.begin(), kept.end(), is.subtype) != kept.end();
    REQUIRE(find_travel(is.subtype) != nullptr);
    CHECK(has_phase(is.subtype) != stays);
  }
  // A service's own record: its name is the middleware's, proto knows no body of it.
  CHECK(is_reserved("journal_run"));
  CHECK_FALSE(is_typed("journal_run"));
  CHECK_FALSE(has_phase("journal_run"));
  CHECK_FALSE(is_reserved("move"));
  CHECK(phase_of("move") == CostPhase::task);
  CHECK(phase_of("baton") == CostPhase::forward);
  CHECK_FALSE(has_phase("move"));
  for (const std::string_view word : {"", "a", "abort", "move", "zzz"}) CHECK(find_travel(word) == nullptr);
  CHECK(find_travel("stop")->scope == Scope::fleet);
  CHECK(find_travel("execute")->scope == Scope::bus);
}

TEST_CASE("proto/README.md prints the phases as they are") {
  const auto readme = read_file(test::source_dir() + "/proto/README.md");
  REQUIRE(readme.ok());
  INFO("put this between the marks:\n" << phases_text());
  CHECK(readme->find("<!-- phases -->\n" + phases_text() + "<!-- /phases -->") != std::string::npos);
}
