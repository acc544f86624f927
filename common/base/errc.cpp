#include "common/base/errc.hpp"

namespace trb {

std::string_view errc_name(Errc code) {
  switch (code) {
    case Errc::ok:
      return "ok";
    case Errc::malformed:
      return "malformed";
    case Errc::too_large:
      return "too_large";
    case Errc::bad_value:
      return "bad_value";
    case Errc::missing:
      return "missing";
    case Errc::unknown_key:
      return "unknown_key";
    case Errc::duplicate:
      return "duplicate";
    case Errc::version_mismatch:
      return "version_mismatch";
    case Errc::does_not_fit_figure_3:
      return "does_not_fit_figure_3";
    case Errc::unknown_target:
      return "unknown_target";
    case Errc::peer_expired:
      return "peer_expired";
    case Errc::peer_unreachable:
      return "peer_unreachable";
    case Errc::queue_full:
      return "queue_full";
    case Errc::no_service:
      return "no_service";
    case Errc::no_field_channel:
      return "no_field_channel";
    case Errc::robot_offline:
      return "robot_offline";
    case Errc::timeout:
      return "timeout";
    case Errc::expired:
      return "expired";
    case Errc::not_confirmed:
      return "not_confirmed";
    case Errc::fenced:
      return "fenced";
    case Errc::busy:
      return "busy";
    case Errc::out_of_use:
      return "out_of_use";
    case Errc::unknown_subtype:
      return "unknown_subtype";
    case Errc::unknown_skill:
      return "unknown_skill";
    case Errc::unknown_place:
      return "unknown_place";
    case Errc::not_escapable:
      return "not_escapable";
    case Errc::robot_error:
      return "robot_error";
    case Errc::stale_instance:
      return "stale_instance";
    case Errc::bad_signature:
      return "bad_signature";
    case Errc::foreign_fleet:
      return "foreign_fleet";
    case Errc::wrong_key:
      return "wrong_key";
    case Errc::cert_expired:
      return "cert_expired";
    case Errc::cert_not_yet_valid:
      return "cert_not_yet_valid";
    case Errc::source_mismatch:
      return "source_mismatch";
    case Errc::not_permitted:
      return "not_permitted";
    case Errc::unknown_peer_key:
      return "unknown_peer_key";
    case Errc::cert_revoked:
      return "cert_revoked";
    case Errc::replayed:
      return "replayed";
    case Errc::downgraded:
      return "downgraded";
    case Errc::seal_broken:
      return "seal_broken";
    case Errc::not_asked:
      return "not_asked";
    case Errc::control_held:
      return "control_held";
    case Errc::unknown_run:
      return "unknown_run";
    case Errc::already_claimed:
      return "already_claimed";
    case Errc::conflict:
      return "conflict";
    case Errc::io_error:
      return "io_error";
  }
  return "unknown_error";
}

std::optional<Errc> errc_of(std::string_view name) {
  for (int value = 0; value <= static_cast<int>(Errc::io_error); ++value) {
    const auto code = static_cast<Errc>(value);
    if (errc_name(code) == name) return code;
  }
  return std::nullopt;
}

}  // namespace trb
