#include "common/base/errc.hpp"

#include <array>
#include <cstddef>

namespace trb {
namespace {

struct Row {
  Errc code;
  std::string_view name;
};
#define TRB_ROW(NAME) \
  Row {               \
    Errc::NAME, #NAME \
  }
/// In the order of the codes.
constexpr std::array kRows{
    TRB_ROW(ok),
    TRB_ROW(malformed),
    TRB_ROW(too_large),
    TRB_ROW(bad_value),
    TRB_ROW(missing),
    TRB_ROW(unknown_key),
    TRB_ROW(duplicate),
    TRB_ROW(version_mismatch),
    TRB_ROW(does_not_fit_figure_3),
    TRB_ROW(unknown_target),
    TRB_ROW(peer_expired),
    TRB_ROW(peer_unreachable),
    TRB_ROW(queue_full),
    TRB_ROW(no_service),
    TRB_ROW(no_field_channel),
    TRB_ROW(robot_offline),
    TRB_ROW(timeout),
    TRB_ROW(expired),
    TRB_ROW(not_confirmed),
    TRB_ROW(fenced),
    TRB_ROW(busy),
    TRB_ROW(out_of_use),
    TRB_ROW(unknown_subtype),
    TRB_ROW(unknown_skill),
    TRB_ROW(unknown_place),
    TRB_ROW(not_escapable),
    TRB_ROW(robot_error),
    TRB_ROW(stale_instance),
    TRB_ROW(bad_signature),
    TRB_ROW(foreign_fleet),
    TRB_ROW(wrong_key),
    TRB_ROW(cert_expired),
    TRB_ROW(cert_not_yet_valid),
    TRB_ROW(source_mismatch),
    TRB_ROW(not_permitted),
    TRB_ROW(unknown_peer_key),
    TRB_ROW(cert_revoked),
    TRB_ROW(replayed),
    TRB_ROW(downgraded),
    TRB_ROW(seal_broken),
    TRB_ROW(not_asked),
    TRB_ROW(control_held),
    TRB_ROW(unknown_run),
    TRB_ROW(already_claimed),
    TRB_ROW(conflict),
    TRB_ROW(io_error),
};
#undef TRB_ROW

constexpr bool is_in_order() {
  for (std::size_t i = 0; i < kRows.size(); ++i) {
    if (static_cast<std::size_t>(kRows[i].code) != i) return false;
  }
  return true;
}
static_assert(is_in_order() && kRows.back().code == Errc::io_error, "a row for every code, in their order");

}  // namespace

std::string_view errc_name(Errc code) {
  const auto at = static_cast<std::size_t>(code);
  return at < kRows.size() ? kRows[at].name : "unknown_error";
}

std::optional<Errc> errc_of(std::string_view name) {
  for (const Row& row : kRows) {
    if (row.name == name) return row.code;
  }
  return std::nullopt;
}

}  // namespace trb
