// Error codes of expected failures. Every code is named on the wire and in logs by errc_name().
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

namespace trb {

enum class Errc : std::uint8_t {
  ok = 0,
  // input
  malformed,              ///< bytes that are not a message, body or record
  too_large,              ///< a size, count or depth over its bound
  bad_value,              ///< well-formed, but not allowed there
  missing,                ///< a required field, key or file is not there
  unknown_key,            ///< a key that the schema does not have
  duplicate,              ///< an id that may occur only once occurs twice
  version_mismatch,       ///< a version this build does not speak
  does_not_fit_figure_3,  ///< the message is too long for the paper's datagram
  // delivery
  unknown_target,    ///< a node id that was never seen
  peer_expired,      ///< the target's lease has run out
  peer_unreachable,  ///< the link is down and not yet expired
  queue_full,        ///< a bounded queue is full
  no_service,        ///< the service that takes this subtype is not running
  no_field_channel,  ///< the interpreter mode needs a robot on TCP_PORT; none is connected
  robot_offline,     ///< the robot's own connection is down
  timeout,           ///< the answer or the end did not arrive in time
  expired,           ///< the deadline had passed on arrival
  not_confirmed,     ///< it was sent, but not confirmed: it may or may not have arrived
  // robot
  fenced,           ///< stopped by `stop`; `release` is needed
  busy,             ///< another skill is running; only one at a time
  out_of_use,       ///< a current fault, or a person, keeps the robot or the capability out of use
  unknown_subtype,  ///< the mode has no translation for this subtype
  unknown_skill,    ///< the description has no such skill
  unknown_place,    ///< the hall has no such place
  not_escapable,    ///< text that the robot's language cannot carry safely
  robot_error,      ///< the robot refused; its own text is in the context
  stale_instance,   ///< addressed to an earlier start of the service
  // trust
  bad_signature,
  foreign_fleet,
  wrong_key,
  cert_expired,
  cert_not_yet_valid,
  source_mismatch,  ///< the source is not the connection's certificate's id
  not_permitted,    ///< the role has no right to do that
  unknown_peer_key,
  cert_revoked,  ///< the certificate is on the fleet's revocation list
  replayed,      ///< not newer than one already received
  downgraded,    ///< an older certificate, list or protection than the known one
  seal_broken,   ///< a seal is missing, wrong, late or out of order
  not_asked,     ///< an answer from a node that was not asked
  control_held,  ///< another node has the control lease of this robot
  // state
  unknown_run,
  already_claimed,
  conflict,
  io_error,
};

/// The code's wire and log name, for example "no_field_channel".
std::string_view errc_name(Errc code);

/// The code of that name.
std::optional<Errc> errc_of(std::string_view name);

}  // namespace trb
