#include "services/scheduler/core/journal_records.hpp"

#include <doctest/doctest.h>

#include <algorithm>

#include "common/base/hex.hpp"

using namespace trb;
using namespace trb::scheduler;

namespace {

const SignedRecord kRecord{"result", "ur3", {"p"}, {"s"}};
constexpr const char* kRecordHex = "94a6726573756c74a3757233c40170c40173";

/// One of each kind, as a journal has it.
std::vector<JournalRecord> one_of_each() {
  return {JournalRun{kRecord, true},
          JournalStart{{"r", "t", 1, 2}, 3, 300, -6},
          JournalResult{kRecord},
          JournalChoice{kRecord},
          JournalDelivered{"r", "ur3", "baton", {1, 2}, 3},
          JournalAbort{kRecord, false},
          JournalDecision{kRecord, true},
          JournalPause{kRecord, true},
          JournalEnd{kRecord},
          JournalArchive{{}, {kRecord}, {kRecord}, {}, {}, kRecord, 7},
          JournalTime{5},
          JournalLost{5, true},
          JournalTombstone{"r", RunState::aborted, 7}};
}

}  // namespace

TEST_CASE("the bytes on disk, written down: a journal outlives a build") {
  const std::string one = kRecordHex;
  CHECK(to_hex(encode_record(JournalRun{kRecord, true})) == "92" + one + "c3");
  CHECK(to_hex(encode_record(JournalStart{{"r", "t", 1, 2}, 3, 300, -6})) == "9494a172a174010203cd012cfa");
  CHECK(to_hex(encode_record(JournalResult{kRecord})) == "91" + one);
  CHECK(to_hex(encode_record(JournalChoice{kRecord})) == "91" + one);
  CHECK(to_hex(encode_record(JournalDelivered{"r", "ur3", "baton", {1, 2}, 3})) ==
        "95a172a3757233a56261746f6e92010203");
  CHECK(to_hex(encode_record(JournalAbort{kRecord, false})) == "92" + one + "c2");
  CHECK(to_hex(encode_record(JournalDecision{kRecord, true})) == "92" + one + "c3");
  CHECK(to_hex(encode_record(JournalPause{kRecord, true})) == "92" + one + "c3");
  CHECK(to_hex(encode_record(JournalEnd{kRecord})) == "91" + one);
  JournalArchive over{{}, {kRecord}, {kRecord}, {}, {}, kRecord, 7};
  over.view.run = "r";
  over.view.state = RunState::finished;
  const std::string fields = "a172a003a001a00000909000a000cb0000000000000000";
  const std::string rest = "91" + one + "91" + one + "9090" + one + "07" + "94a0a0c400c400";
  CHECK(to_hex(encode_record(over)) == "98dc0010" + fields + "00c2" + rest);
  const auto earlier = decode_record(JournalArchive::kKind, *from_hex("989f" + fields + "00" + rest));
  REQUIRE(earlier.ok());  // of a version whose views had no `recovers`
  CHECK(encode_record(*earlier) == encode_record(over));
  CHECK(to_hex(encode_record(JournalTime{5})) == "9105");
  CHECK(to_hex(encode_record(JournalLost{5, true})) == "9205c3");
  CHECK(to_hex(encode_record(JournalTombstone{"r", RunState::aborted, 7})) == "93a1720407");
}

TEST_CASE("every kind comes back as it was, a cut one is refused, a newer build's longer one is read") {
  const auto all = one_of_each();
  REQUIRE(all.size() == std::variant_size_v<JournalRecord>);
  for (const JournalRecord& record : all) {
    CAPTURE(kind_of(record));
    const Bytes bytes = encode_record(record);
    const auto back = decode_record(kind_of(record), bytes);
    REQUIRE(back.ok());
    CHECK(back->index() == record.index());
    CHECK(encode_record(*back) == bytes);
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const auto cut = decode_record(kind_of(record), bytes.substr(0, size));
      REQUIRE_FALSE(cut.ok());
      CHECK(cut.error().what.starts_with(std::string(kind_of(record)) + ": "));
    }
    Bytes longer = bytes + '\x07';
    longer[0] = static_cast<char>(longer[0] + 1);
    const auto newer = decode_record(kind_of(record), longer);
    REQUIRE(newer.ok());
    CHECK(encode_record(*newer) == bytes);
    const auto shortest = decode_record(kind_of(record), "\x90");
    REQUIRE(shortest.ok());
    CHECK(shortest->index() == record.index());
  }
  CHECK(decode_record("journal_of_tomorrow", "\x90").error().code == Errc::bad_value);
  CHECK(decode_record("stop", "\x90").error().code == Errc::bad_value);
}

TEST_CASE("what a core has recorded is taken for what it is, and another service's is refused") {
  const auto start = to_journal_record(std::any(JournalStart{{"r", "t", 1, 2}, 3, 300, -6}));
  REQUIRE(start.ok());
  CHECK(std::get<JournalStart>(*start).instance == 300);
  CHECK(to_journal_record(std::any(Stop{"no record"})).error().code == Errc::bad_value);
  CHECK(to_journal_record({}).error().code == Errc::bad_value);
}

TEST_CASE("every kind is reserved, and never a message: no user's word is taken for one") {
  const auto all = one_of_each();
  for (const JournalRecord& record : all) {
    CAPTURE(kind_of(record));
    CHECK(is_reserved(kind_of(record)));
    CHECK_FALSE(is_typed(kind_of(record)));
    REQUIRE(find_travel(kind_of(record)) != nullptr);
    CHECK(find_travel(kind_of(record))->scope == Scope::record);
  }
  CHECK(std::ranges::count_if(travel_rows(), [](const TravelRow& row) {
          return row.subtype.starts_with("journal_");
        }) == static_cast<std::ptrdiff_t>(all.size()));
  CHECK_FALSE(is_reserved("journal_of_tomorrow"));
}
