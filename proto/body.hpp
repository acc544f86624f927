// The list of every body, and the two codecs made from it.
#pragma once

#include <variant>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "proto/bodies/bridge.hpp"
#include "proto/bodies/bus.hpp"
#include "proto/bodies/journal.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/resilience.hpp"
#include "proto/bodies/robot.hpp"
#include "proto/bodies/run.hpp"
#include "proto/bodies/sensor.hpp"
#include "proto/bodies/signed.hpp"

// One line a body; the order means nothing on the wire.
// clang-format off
#define TRB_BODIES(X)                                                                                              \
  X(ServiceHello) X(ServiceWelcome) X(ServiceAlive) X(ServiceAliveSeen) X(HelloWanted) X(Nack) X(Ack)              \
  X(SignRequest) X(SignedRecord) X(RouteListRequest) X(RouteTable) X(ServiceListRequest) X(ServiceTable)           \
  X(RouterCountersRequest) X(AdapterCountersRequest) X(Counters)                                                   \
  X(Certificate) X(CertificateRequest) X(Beacon) X(NodeProfile) X(Hello) X(KeepAlive) X(Goodbye) X(PeerJoined)     \
  X(RevocationList) X(Seal) X(SealedRange) X(FleetNews) X(Neighbours) X(Relayed) X(RelayedFrame)                   \
  X(LinkTroublesRequest) X(LinkTroubles) X(EchoRequest) X(Echo)                                                    \
  X(PeerExpired) X(Execute) X(CancelExecution) X(ExecutionQuery) X(ExecutionState) X(Outcome) X(OutcomeJournaled)  \
  X(AdapterState) X(AdapterStateRequest) X(RobotFault) X(RobotConnection) X(RobotState) X(InjectFault)             \
  X(NodeSensors) X(SensorRead) X(SensorReading) X(SensorWatch) X(SensorSnapshot) X(SensorImage)                    \
  X(SensorListRequest) X(SensorTable)                                                                              \
  X(Stop) X(Release) X(BridgeCommand) X(BridgeEvent) X(BridgeState)                                                \
  X(Scenario) X(RunStart) X(TaskResult) X(AbortOrder) X(RunSubmit) X(RunAccepted) X(Baton) X(BatonJournaled)       \
  X(NeedDefinition) X(Definition) X(NeedResults) X(Results) X(ResultsJournaled) X(TaskProgress) X(RunAbort)        \
  X(AbortConfirmed) X(RunQuery) X(RunView) X(RunListRequest) X(RunTable) X(Choice)                                 \
  X(JournalRun) X(JournalStart) X(JournalResult) X(JournalDelivered) X(JournalAbort) X(JournalTombstone)           \
  X(JournalChoice) X(JournalDecision) X(JournalPause)                                                              \
  X(Decision) X(RunDecision) X(DecisionJournaled) X(ReleaseTasks) X(PauseOrder) X(RunPause) X(PauseJournaled)      \
  X(RunWatch) X(RunChanged) X(Alert) X(AlertListRequest) X(AlertTable) X(AlertDecide)
// clang-format on

namespace trb {

/// The data of a subtype that no body is defined for: a user's own words, handed through as they are.
struct Opaque {
  std::string subtype;
  Bytes data;
  bool operator==(const Opaque&) const = default;
};

/// Any body.
using Body = std::variant<Opaque
#define TRB_ALTERNATIVE(Name) , Name
                              TRB_BODIES(TRB_ALTERNATIVE)
#undef TRB_ALTERNATIVE
                          >;

struct DecodeLimits {
  std::size_t bytes = 1U << 20U;
  std::size_t depth = 32;
  std::size_t items = 100'000;
};

/// msgpack: an array in declared order. Encoding cuts a text that is over its bound. Decoding ignores an unknown tail
/// and fills a missing one with defaults. Errors: malformed, too_large, bad_value; the text names the field by its path
/// ("tasks[3].id").
template <class T>
Bytes encode(const T& body);
template <class T>
Result<T> decode(BytesView bytes);

/// JSON: an object by field names. Decoding refuses a key that is no field; a missing key is its default.
template <class T>
std::string to_json(const T& body);
template <class T>
Result<T> from_json(std::string_view json);

/// True if a body is defined for the subtype: it belongs to the middleware and never reaches a robot as fields.
bool is_typed(std::string_view subtype);

std::string_view subtype_of(const Body& body);
Bytes encode_body(const Body& body);

/// Opaque for a subtype that is not typed.
Result<Body> decode_body(std::string_view subtype, BytesView data);

/// The data of a typed subtype as JSON text, and back.
Result<std::string> body_to_json(std::string_view subtype, BytesView data);
Result<Bytes> body_from_json(std::string_view subtype, std::string_view json);

}  // namespace trb
