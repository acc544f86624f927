// How a body lists its fields, once: both codecs (msgpack, JSON) are made from this list.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace trb {

/// Bytes that are not text: msgpack bin, hexadecimal in JSON.
struct Blob {
  std::string bytes;
  bool operator==(const Blob&) const = default;
};

constexpr std::uint32_t kDefaultMaxSize = 255;

struct Shape;  // shape.hpp

/// The only shape of a field's type. Its templates are in make_shape.hpp, so that only the codec pays for them.
template <class T>
const Shape& make_shape();

/// One field of a body. `max` bounds a text or blob in bytes and a list in items; numbers ignore it.
struct FieldEntry {
  std::string_view name;
  std::ptrdiff_t offset = 0;  ///< in the struct, bytes
  const Shape* shape = nullptr;
  std::uint32_t max = kDefaultMaxSize;
};

/// The fields of a struct, in msgpack's order.
using FieldTable = std::vector<FieldEntry>;

template <class Owner, class Member>
FieldEntry field(std::string_view name, Member Owner::*member, std::uint32_t max = kDefaultMaxSize) {
  static_assert(std::is_standard_layout_v<Owner>, "only such a struct's fields have a place of their own in it");
  // A pointer to a data member holds its offset: the Itanium ABI, which GCC and clang follow, defines it so.
  return {name, std::bit_cast<std::ptrdiff_t>(member), &make_shape<Member>(), max};
}

/// A struct with a field list: a body or a part of one.
template <class T>
concept Fielded = requires {
  T::fields();
};

/// An enum whose names `enum_names(E)` lists, in the order of its values from 0.
template <class E>
concept NamedEnum = std::is_enum_v<E> && requires(E e) {
  enum_names(e);
};

/// The name of an enum's value, as JSON, logs and the command line show it.
template <NamedEnum E>
constexpr std::string_view name_of(E value) {
  constexpr auto names = enum_names(E{});
  const auto index = static_cast<std::size_t>(value);
  return index < names.size() ? names[index] : std::string_view("?");
}

template <class T>
struct IsVector : std::false_type {};
template <class T>
struct IsVector<std::vector<T>> : std::true_type {};

}  // namespace trb
