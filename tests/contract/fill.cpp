#include "tests/contract/fill.hpp"

#include <array>
#include <string>

#include "proto/shape.hpp"

namespace trb::contract {
namespace {

template <class T>
Result<Body> any(Result<T> body) {
  if (!body) return body.error();
  return Body{std::move(*body)};
}

template <class T>
constexpr AnyBody any_body() {
  return {.subtype = T::kSubtype,
          .kind = BodyKindOf<T>::value,
          .encode = [](const Body& body) { return encode(get<T>(body)); },
          .decode = [](BytesView bytes) { return any(decode<T>(bytes)); },
          .to_json = [](const Body& body) { return to_json(get<T>(body)); },
          .from_json = [](std::string_view json) { return any(from_json<T>(json)); }};
}

class Filler {
 public:
  void fill(const Shape& shape, void* out, std::uint32_t max) {
    ++count_;
    switch (shape.kind) {
      case FieldKind::boolean:
        as<bool>(out) = !as<bool>(out);
        return;
      case FieldKind::enumeration:
        as<std::uint8_t>(out) = static_cast<std::uint8_t>(shape.names.size() - 1);
        return;
      case FieldKind::uint16:
        as<std::uint16_t>(out) = static_cast<std::uint16_t>(100 + count_);
        return;
      case FieldKind::uint32:
        as<std::uint32_t>(out) = 100 + count_;
        return;
      case FieldKind::uint64:
        as<std::uint64_t>(out) = ~std::uint64_t{0} - count_;
        return;
      case FieldKind::int64:
        as<std::int64_t>(out) = -1'772'366'400'000'000'000 - count_;
        return;
      case FieldKind::number:
        as<double>(out) = 0.25 + count_;
        return;
      case FieldKind::text:
        as<std::string>(out) = ("Zoë" + std::to_string(count_)).substr(0, max);
        return;
      case FieldKind::blob:
        as<Blob>(out).bytes = std::string("\x00\xff\x80", 3) + static_cast<char>(count_);
        return;
      case FieldKind::list: {
        void* at = shape.list.renew(out, 2);
        for (int i = 0; i < 2; ++i, at = behind(at, shape.list.stride)) fill(*shape.list.item, at, kDefaultMaxSize);
        return;
      }
      case FieldKind::record:
        for (const FieldEntry& f : shape.fields) fill(*f.shape, behind(out, f.offset), f.max);
    }
  }

 private:
  std::uint32_t count_ = 0;
};

bool same(const Shape& shape, const void* a, const void* b);

bool same_list(const ListShape& shape, const void* a, const void* b) {
  const std::size_t size = shape.size(a);
  if (shape.size(b) != size) return false;
  a = shape.data(a);
  b = shape.data(b);
  for (std::size_t i = 0; i < size; ++i, a = behind(a, shape.stride), b = behind(b, shape.stride)) {
    if (!same(*shape.item, a, b)) return false;
  }
  return true;
}

bool same(const Shape& shape, const void* a, const void* b) {
  switch (shape.kind) {
    case FieldKind::boolean:
      return as<bool>(a) == as<bool>(b);
    case FieldKind::enumeration:
      return as<std::uint8_t>(a) == as<std::uint8_t>(b);
    case FieldKind::uint16:
      return as<std::uint16_t>(a) == as<std::uint16_t>(b);
    case FieldKind::uint32:
      return as<std::uint32_t>(a) == as<std::uint32_t>(b);
    case FieldKind::uint64:
      return as<std::uint64_t>(a) == as<std::uint64_t>(b);
    case FieldKind::int64:
      return as<std::int64_t>(a) == as<std::int64_t>(b);
    case FieldKind::number:
      return as<double>(a) == as<double>(b);
    case FieldKind::text:
      return as<std::string>(a) == as<std::string>(b);
    case FieldKind::blob:
      return as<Blob>(a) == as<Blob>(b);
    case FieldKind::list:
      return same_list(shape.list, a, b);
    case FieldKind::record:
      break;
  }
  for (const FieldEntry& f : shape.fields) {
    if (!same(*f.shape, behind(a, f.offset), behind(b, f.offset))) return false;
  }
  return true;
}

}  // namespace

std::span<const AnyBody> every_body() {
  static constexpr std::array kAll{
#define TRB_ANY(Name) any_body<Name>(),
      TRB_BODIES(TRB_ANY)
#undef TRB_ANY
  };
  return kAll;
}

Body filled(BodyKind kind) {
  Body out = Body::of(kind);
  Filler().fill(shape_of(kind), out.data(), kDefaultMaxSize);
  return out;
}

bool same(const Body& a, const Body& b) {
  return a.kind() == b.kind() && same(shape_of(a.kind()), a.data(), b.data());
}

}  // namespace trb::contract
