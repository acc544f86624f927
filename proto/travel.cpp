#include "proto/travel.hpp"

#include <algorithm>

#include "common/base/lookup_table.hpp"
#include "proto/body.hpp"

namespace trb {
namespace {

/// A record in a service's own file: its struct is that service's, its name was never a user's to take.
constexpr TravelRow kept(std::string_view kind) {
  return {kind, in_record()};
}

constexpr auto kRows = [] {
  std::array rows{
#define TRB_ROW(Name) TravelRow{Name::kSubtype, Name::kTravel},
      TRB_BODIES(TRB_ROW)
#undef TRB_ROW
      // The scheduler's journal.
      kept("journal_abort"),
      kept("journal_archive"),
      kept("journal_choice"),
      kept("journal_decision"),
      kept("journal_delivered"),
      kept("journal_end"),
      kept("journal_lost"),
      kept("journal_pause"),
      kept("journal_result"),
      kept("journal_run"),
      kept("journal_start"),
      kept("journal_time"),
      kept("journal_tombstone")};
  std::ranges::sort(rows, {}, &TravelRow::subtype);
  return rows;
}();
static_assert(std::ranges::adjacent_find(kRows, {}, &TravelRow::subtype) == kRows.end(), "two words are one");

constexpr WordIndex<kRows.size()> kRowByWord([] {
  std::array<std::string_view, kRows.size()> words;
  std::ranges::transform(kRows, words.begin(), &TravelRow::subtype);
  return words;
}());

}  // namespace

std::span<const TravelRow> travel_rows() {
  return kRows;
}

const Travel* find_travel(std::string_view subtype) {
  const std::size_t at = kRowByWord.find(subtype);
  return at == kRowByWord.kNone ? nullptr : &kRows[at].travel;
}

std::string phases_text() {
  std::string out = "| Phase | Subtypes |\n|---|---|\n";
  for (const CostPhase phase : {CostPhase::boot, CostPhase::identification, CostPhase::devices, CostPhase::task,
                                CostPhase::forward, CostPhase::sensor, CostPhase::fail}) {
    out += "| " + std::string(name_of(phase)) + " |";
    for (const auto& [subtype, travel] : kRows) {
      if (travel.phase == phase) out += " " + std::string(subtype);
    }
    out += phase == CostPhase::task ? ", and every word of the user's |\n" : " |\n";
  }
  return out + "| upkeep | every other one: what the paper does not count |\n";
}

bool has_phase(std::string_view subtype) {
  const Travel* travel = find_travel(subtype);
  return travel != nullptr && travel->phase.has_value();
}

CostPhase phase_of(std::string_view subtype) {
  const Travel* travel = find_travel(subtype);
  return travel == nullptr ? CostPhase::task : travel->phase.value_or(CostPhase::task);
}

}  // namespace trb
