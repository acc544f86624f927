// The list of every body, and the two codecs made from it.
#pragma once

#include <algorithm>
#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>
#include <variant>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "proto/bodies/bridge.hpp"
#include "proto/bodies/bus.hpp"
#include "proto/bodies/invitation.hpp"
#include "proto/bodies/link.hpp"
#include "proto/bodies/resilience.hpp"
#include "proto/bodies/robot.hpp"
#include "proto/bodies/run_view.hpp"
#include "proto/bodies/sensor.hpp"
#include "proto/bodies/signed.hpp"

// One line for each body; their order does not matter on the wire.
// clang-format off
#define TRB_BODIES(X)                                                                                              \
  X(ServiceHello) X(ServiceWelcome) X(ServiceAlive) X(ServiceAliveSeen) X(HelloWanted) X(Nack) X(Ack)              \
  X(SignRequest) X(SignedRecord) X(RouteListRequest) X(RouteTable) X(ServiceListRequest) X(ServiceTable)           \
  X(RouterCountersRequest) X(AdapterCountersRequest) X(ServiceCountersRequest) X(Counters)                           \
  X(Certificate) X(CertificateRequest) X(Beacon) X(NodeProfile) X(Hello) X(KeepAlive) X(Goodbye) X(PeerJoined)     \
  X(RevocationList) X(Seal) X(SealedRange) X(TrustUpdate) X(ReachablePeerList) X(Relayed) X(RelayedFrame)                   \
  X(RelayAlive) X(RelayRefused)                                                                                    \
  X(LinkErrorTableRequest) X(LinkErrorTable) X(EchoRequest) X(Echo)                                                    \
  X(PeerExpired) X(RevokedNodes) X(Execute) X(CancelExecution) X(ExecutionQuery) X(ExecutionState) X(Outcome) X(OutcomeJournaled)  \
  X(AdapterState) X(AdapterStateRequest) X(RobotFault) X(TakeOutOfUse) X(TakeIntoUse) X(RobotConnection) X(RobotState) X(InjectFault)             \
  X(NodeSensors) X(SensorRead) X(SensorReading) X(SensorWatch) X(SensorSnapshot) X(SensorImage)                    \
  X(SensorListRequest) X(SensorTable)                                                                              \
  X(Stop) X(Release) X(Velocity) X(BridgeCommand) X(BridgeEvent) X(BridgeState)                                                \
  X(Scenario) X(RunStart) X(TaskResult) X(AbortOrder) X(RunSubmit) X(RunAccepted) X(Baton) X(BatonJournaled)       \
  X(NeedDefinition) X(Definition) X(NeedResults) X(Results) X(ResultsJournaled) X(TaskProgress) X(RunAbort)        \
  X(AbortConfirmed) X(RunEnd) X(RunOver) X(NeedEnd) X(RunQuery) X(RunView) X(RunListRequest) X(RunTable) X(RunProofRequest) X(RunRecords) X(Choice)                                 \
  X(Decision) X(RunDecision) X(DecisionJournaled) X(ReleaseTasks) X(PauseOrder) X(RunPause) X(PauseJournaled)      \
  X(RunWatch) X(RunChanged) X(Alert) X(AlertListRequest) X(AlertTable) X(AlertDecide)                        \
  X(HistoryListRequest) X(HistoryTable) X(AlertRankRequest) X(AlertRanking) X(DecidedElsewhere)                 \
  X(Invitation) X(HoldInvitation) X(InvitationState) X(JoinCall) X(JoinAnswer) X(JoinOffer) X(JoinWord)
// clang-format on

namespace trb {

/// The data of a subtype without a defined body: a user's own message, passed on unchanged.
struct Opaque {
  std::string subtype;
  Bytes data;
  bool operator==(const Opaque&) const = default;
};

/// Which body is in a Body.
enum class BodyKind : std::uint8_t {
  Opaque = 0,
#define TRB_KIND(Name) Name,
  TRB_BODIES(TRB_KIND)
#undef TRB_KIND
};

template <class T>
struct BodyKindOf;
template <>
struct BodyKindOf<Opaque> : std::integral_constant<BodyKind, BodyKind::Opaque> {};
#define TRB_KIND_OF(Name) \
  template <>             \
  struct BodyKindOf<Name> : std::integral_constant<BodyKind, BodyKind::Name> {};
TRB_BODIES(TRB_KIND_OF)
#undef TRB_KIND_OF

/// True for Opaque and every body of the list.
template <class T>
concept IsBody = requires {
  BodyKindOf<T>::value;
};

/// Any body. Used like std::variant (get_if, get, holds_alternative, visit), but not one: each of a variant's symbols
/// would name the whole list, at ten seconds and fifty megabytes for every file that copies one.
class Body {
 public:
  Body() : Body(Opaque{}) {}
  template <IsBody T>
  Body(T value) : kind_(BodyKindOf<T>::value) {  // NOLINT: any body is one
    ::new (static_cast<void*>(storage_)) T(std::move(value));
  }
  Body(const Body& other);
  Body(Body&& other) noexcept;
  Body& operator=(const Body& other);
  Body& operator=(Body&& other) noexcept;
  ~Body();

  /// A body of that kind with every field at its default.
  static Body of(BodyKind kind) { return Body(kind); }

  [[nodiscard]] BodyKind kind() const { return kind_; }

  /// The body's struct, for code that walks it by its shape (shape.hpp).
  [[nodiscard]] const void* data() const { return storage_; }
  [[nodiscard]] void* data() { return storage_; }

  template <IsBody T>
  friend const T* get_if(const Body* body) {
    if (body->kind_ != BodyKindOf<T>::value) return nullptr;
    return std::launder(reinterpret_cast<const T*>(body->storage_));
  }

 private:
  static constexpr std::size_t kSize = std::max({sizeof(Opaque)
#define TRB_SIZE(Name) , sizeof(Name)
                                                     TRB_BODIES(TRB_SIZE)
#undef TRB_SIZE
  });
  explicit Body(BodyKind kind);

  BodyKind kind_;
  alignas(std::max_align_t) unsigned char storage_[kSize];
};

template <IsBody T>
const T* get_if(const Body* body);

template <IsBody T>
T* get_if(Body* body) {
  return const_cast<T*>(get_if<T>(static_cast<const Body*>(body)));
}

template <IsBody T>
bool holds_alternative(const Body& body) {
  return body.kind() == BodyKindOf<T>::value;
}

/// Throws std::bad_variant_access if it is of another type.
template <IsBody T>
const T& get(const Body& body) {
  if (!holds_alternative<T>(body)) throw std::bad_variant_access();
  return *get_if<T>(&body);
}
template <IsBody T>
T& get(Body& body) {
  return const_cast<T&>(get<T>(static_cast<const Body&>(body)));
}

/// Calls the visitor with the struct that the body holds.
template <class Visitor>
decltype(auto) visit(Visitor&& visitor, const Body& body) {
  switch (body.kind()) {
#define TRB_CASE(Name) \
  case BodyKind::Name: \
    return visitor(*get_if<Name>(&body));
    TRB_BODIES(TRB_CASE)
#undef TRB_CASE
    case BodyKind::Opaque:
      break;
  }
  return visitor(*get_if<Opaque>(&body));
}

struct DecodeLimits {
  std::size_t bytes = 1U << 20U;
  std::size_t depth = 32;
  std::size_t items = 100'000;
};

/// The codecs, without the body's type: `value` is the struct that the shape describes. The error's code is `ok` if
/// there was none; otherwise the value is only partly filled in. `limits`: a message's; others for bytes of this node's
/// own, which may be longer.
const Shape& shape_of(BodyKind kind);
Bytes pack(const Shape& shape, const void* value);
Result<Bytes> pack_readable(const Shape& shape, const void* value);
Error unpack(const Shape& shape, BytesView bytes, void* value, const DecodeLimits& limits = {});
std::string write_json(const Shape& shape, const void* value);
Error read_json(const Shape& shape, std::string_view json, void* value);

/// msgpack: an array in declared order. Encoding cuts a text that exceeds its bound. Decoding ignores an unknown tail
/// and fills a missing one with defaults. Errors: malformed, too_large, bad_value; the text names the field by its path
/// ("tasks[3].id").
template <class T>
Bytes encode(const T& body) {
  return pack(shape_of(BodyKindOf<T>::value), &body);
}
/// The same, for data that goes to another process: fails if its reader would refuse it. Errors: too_large (a list or
/// blob over its bound, or the whole over 1 MiB), bad_value (a number that is not finite); the text names the field.
template <class T>
Result<Bytes> pack(const T& body) {
  return pack_readable(shape_of(BodyKindOf<T>::value), &body);
}
template <class T>
Result<T> decode(BytesView bytes) {
  T out{};
  Error error = unpack(shape_of(BodyKindOf<T>::value), bytes, &out);
  if (error.code != Errc::ok) return error;
  return out;
}

/// JSON: an object with the fields' names as keys. Decoding refuses an unknown key; a missing key takes its default.
template <class T>
std::string to_json(const T& body) {
  return write_json(shape_of(BodyKindOf<T>::value), &body);
}
template <class T>
Result<T> from_json(std::string_view json) {
  T out{};
  Error error = read_json(shape_of(BodyKindOf<T>::value), json, &out);
  if (error.code != Errc::ok) return error;
  return out;
}

/// True if a body is defined for the subtype. Whether it belongs to the middleware: is_reserved() (travel.hpp).
bool is_typed(std::string_view subtype);

std::string_view subtype_of(const Body& body);
Bytes encode_body(const Body& body);
/// pack() of the body's struct; the error names the subtype, too.
Result<Bytes> pack_body(const Body& body);

/// Opaque for a subtype that is not typed.
Result<Body> decode_body(std::string_view subtype, BytesView data);

/// The data of a typed subtype as JSON text, and back.
Result<std::string> body_to_json(std::string_view subtype, BytesView data);
Result<Bytes> body_from_json(std::string_view subtype, std::string_view json);

}  // namespace trb
