#include "common/operator/nack_error.hpp"

namespace trb::op {
namespace {

/// What to check, as a command of `trb`.
std::string usual_hint(Errc code) {
  switch (code) {
    case Errc::unknown_run:
      return "see trb scenario list";
    case Errc::fenced:
      return "trb release ROBOT lifts the fence";
    case Errc::robot_offline:
      return "see trb robot list; start the robot or check its cable";
    case Errc::unknown_skill:
    case Errc::unknown_place:
      return "see trb route list --json for what the robot can do";
    default:
      return "see trb help errors";
  }
}

}  // namespace

Error nack_error(const Nack& nack) {
  for (int code = 1; code < 256; ++code) {
    const auto known = static_cast<Errc>(code);
    if (errc_name(known) == nack.code) return fail(known, nack.what, nack.hint.empty() ? usual_hint(known) : nack.hint);
  }
  return fail(Errc::bad_value, nack.code + ": " + nack.what, nack.hint);
}

}  // namespace trb::op
