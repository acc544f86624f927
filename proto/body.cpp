#include "proto/body.hpp"

#include <algorithm>
#include <array>

namespace trb {
namespace {

/// Calls visit.template operator()<T>() for the body of that subtype; false if there is none.
template <class Visit>
bool with_body(std::string_view subtype, Visit visit) {
#define TRB_CASE(Name)                 \
  if (subtype == Name::kSubtype) {     \
    visit.template operator()<Name>(); \
    return true;                       \
  }
  TRB_BODIES(TRB_CASE)
#undef TRB_CASE
  return false;
}

constexpr auto sorted_subtypes() {
  std::array names{
#define TRB_NAME(Name) Name::kSubtype,
      TRB_BODIES(TRB_NAME)
#undef TRB_NAME
  };
  std::sort(names.begin(), names.end());
  return names;
}

constexpr auto kTyped = sorted_subtypes();
static_assert(std::adjacent_find(kTyped.begin(), kTyped.end()) == kTyped.end(), "two bodies share a subtype");

/// Calls act.template operator()<T>() for the body of that kind.
template <class Act>
void with_kind(BodyKind kind, Act act) {
  switch (kind) {
#define TRB_CASE(Name)                                                \
  case BodyKind::Name:                                                \
    static_assert(std::is_nothrow_move_constructible_v<Name>, #Name); \
    return act.template operator()<Name>();
    TRB_BODIES(TRB_CASE)
#undef TRB_CASE
    case BodyKind::Opaque:
      return act.template operator()<Opaque>();
  }
}

}  // namespace

Body::Body(const Body& other) : kind_(other.kind_) {
  with_kind(kind_, [&]<class T>() { ::new (static_cast<void*>(storage_)) T(*get_if<T>(&other)); });
}

Body::Body(Body&& other) noexcept : kind_(other.kind_) {
  with_kind(kind_, [&]<class T>() { ::new (static_cast<void*>(storage_)) T(std::move(*get_if<T>(&other))); });
}

Body& Body::operator=(const Body& other) {
  return *this = Body(other);
}

Body& Body::operator=(Body&& other) noexcept {
  if (this == &other) return *this;
  this->~Body();
  return *::new (static_cast<void*>(this)) Body(std::move(other));
}

Body::~Body() {
  with_kind(kind_, [&]<class T>() { get_if<T>(this)->~T(); });
}

bool is_typed(std::string_view subtype) {
  return std::binary_search(kTyped.begin(), kTyped.end(), subtype);
}

std::string_view subtype_of(const Body& body) {
  return visit(
      [](const auto& is) -> std::string_view {
        if constexpr (std::is_same_v<std::decay_t<decltype(is)>, Opaque>) {
          return is.subtype;
        } else {
          return is.kSubtype;
        }
      },
      body);
}

Bytes encode_body(const Body& body) {
  return visit(
      [](const auto& is) -> Bytes {
        if constexpr (std::is_same_v<std::decay_t<decltype(is)>, Opaque>) {
          return is.data;
        } else {
          return encode(is);
        }
      },
      body);
}

Result<Body> decode_body(std::string_view subtype, BytesView data) {
  Result<Body> out = Body{Opaque{std::string(subtype), Bytes(data)}};
  with_body(subtype, [&]<class T>() {
    auto body = decode<T>(data);
    out = body ? Result<Body>(Body{std::move(*body)})
               : Result<Body>(fail(body.error().code, std::string(subtype) + ": " + body.error().what));
  });
  return out;
}

Result<std::string> body_to_json(std::string_view subtype, BytesView data) {
  Result<std::string> out = fail(Errc::unknown_subtype, "no body is defined for " + std::string(subtype));
  with_body(subtype, [&]<class T>() {
    auto body = decode<T>(data);
    out = body ? Result<std::string>(to_json(*body)) : Result<std::string>(body.error());
  });
  return out;
}

Result<Bytes> body_from_json(std::string_view subtype, std::string_view json) {
  Result<Bytes> out = fail(Errc::unknown_subtype, "no body is defined for " + std::string(subtype));
  with_body(subtype, [&]<class T>() {
    auto body = from_json<T>(json);
    out = body ? Result<Bytes>(encode(*body)) : Result<Bytes>(body.error());
  });
  return out;
}

}  // namespace trb
