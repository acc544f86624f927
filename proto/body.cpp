#include "proto/body.hpp"

#include <algorithm>
#include <array>

#include "common/base/lookup_table.hpp"

namespace trb {
namespace {

/// How a body is copied, moved and destroyed. A table, because five switches over every body took the compiler ten
/// seconds.
struct Handling {
  void (*make)(void* at);
  void (*copy)(void* to, const void* from);
  void (*move)(void* to, void* from) noexcept;
  void (*destroy)(void* at);
};

template <class T>
constexpr Handling handling_of() {
  static_assert(std::is_nothrow_move_constructible_v<T>);
  return {.make = [](void* at) { ::new (at) T(); },
          .copy = [](void* to, const void* from) { ::new (to) T(*std::launder(static_cast<const T*>(from))); },
          .move = [](void* to, void* from) noexcept { ::new (to) T(std::move(*std::launder(static_cast<T*>(from)))); },
          .destroy = [](void* at) { std::launder(static_cast<T*>(at))->~T(); }};
}

constexpr std::array kHandling{handling_of<Opaque>(),
#define TRB_HANDLING(Name) handling_of<Name>(),
                               TRB_BODIES(TRB_HANDLING)
#undef TRB_HANDLING
};

const Handling& handling(BodyKind kind) {
  return kHandling[static_cast<std::size_t>(kind)];
}

constexpr std::array kSubtypes{
#define TRB_NAME(Name) Name::kSubtype,
    TRB_BODIES(TRB_NAME)
#undef TRB_NAME
};

static_assert(
    [] {
      auto words = kSubtypes;
      std::ranges::sort(words);
      return std::ranges::adjacent_find(words) == words.end();
    }(),
    "two bodies share a subtype");

constexpr WordIndex<kSubtypes.size()> kKindByWord(kSubtypes);

/// Opaque if no body has that subtype.
BodyKind kind_of(std::string_view subtype) {
  const std::size_t at = kKindByWord.find(subtype);
  return at == kKindByWord.kNone ? BodyKind::Opaque : static_cast<BodyKind>(at + 1);
}

Error no_such_body(std::string_view subtype) {
  return fail(Errc::unknown_subtype, "no body is defined for " + std::string(subtype));
}

}  // namespace

Body::Body(BodyKind kind) : kind_(kind) {
  handling(kind_).make(storage_);
}

Body::Body(const Body& other) : kind_(other.kind_) {
  handling(kind_).copy(storage_, other.storage_);
}

Body::Body(Body&& other) noexcept : kind_(other.kind_) {
  handling(kind_).move(storage_, other.storage_);
}

Body& Body::operator=(const Body& other) {
  return *this = Body(other);
}

Body& Body::operator=(Body&& other) noexcept {
  if (this == &other) return *this;
  handling(kind_).destroy(storage_);
  kind_ = other.kind_;
  handling(kind_).move(storage_, other.storage_);
  return *this;
}

Body::~Body() {
  handling(kind_).destroy(storage_);
}

bool is_typed(std::string_view subtype) {
  return kind_of(subtype) != BodyKind::Opaque;
}

std::string_view subtype_of(const Body& body) {
  if (const auto* opaque = get_if<Opaque>(&body)) return opaque->subtype;
  return kSubtypes[static_cast<std::size_t>(body.kind()) - 1];
}

Bytes encode_body(const Body& body) {
  if (const auto* opaque = get_if<Opaque>(&body)) return opaque->data;
  return pack(shape_of(body.kind()), body.data());
}

Result<Bytes> pack_body(const Body& body) {
  const auto* opaque = get_if<Opaque>(&body);
  Result<Bytes> data = opaque == nullptr ? pack_readable(shape_of(body.kind()), body.data()) : opaque->data;
  const std::size_t most = DecodeLimits{}.bytes;
  if (data && data->size() > most)
    data = fail(Errc::too_large, std::to_string(data->size()) + " bytes, over " + std::to_string(most));
  if (data) return data;
  return fail(data.error().code, std::string(subtype_of(body)) + ": " + data.error().what, "send less at once");
}

Result<Body> decode_body(std::string_view subtype, BytesView data) {
  const BodyKind kind = kind_of(subtype);
  if (kind == BodyKind::Opaque) return Body{Opaque{std::string(subtype), Bytes(data)}};
  Body out = Body::of(kind);
  const Error error = unpack(shape_of(kind), data, out.data());
  if (error.code != Errc::ok) return fail(error.code, std::string(subtype) + ": " + error.what);
  return out;
}

Result<std::string> body_to_json(std::string_view subtype, BytesView data) {
  const BodyKind kind = kind_of(subtype);
  if (kind == BodyKind::Opaque) return no_such_body(subtype);
  Body body = Body::of(kind);
  Error error = unpack(shape_of(kind), data, body.data());
  if (error.code != Errc::ok) return error;
  return write_json(shape_of(kind), body.data());
}

Result<Bytes> body_from_json(std::string_view subtype, std::string_view json) {
  const BodyKind kind = kind_of(subtype);
  if (kind == BodyKind::Opaque) return no_such_body(subtype);
  Body body = Body::of(kind);
  Error error = read_json(shape_of(kind), json, body.data());
  if (error.code != Errc::ok) return error;
  return pack(shape_of(kind), body.data());
}

}  // namespace trb
