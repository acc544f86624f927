// How a body names its fields, once: both codecs (msgpack, JSON) are made from the list.
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

/// Bytes that are no text: msgpack bin, hexadecimal in JSON.
struct Blob {
  std::string bytes;
  bool operator==(const Blob&) const = default;
};

constexpr std::uint32_t kDefaultMaxSize = 255;

struct Shape;  // shape.hpp

/// The only shape of a type that a field may have. Its templates are in make_shape.hpp: only the codec pays for them.
template <class T>
const Shape& make_shape();

/// One field of a body. `max` bounds a text or blob in bytes and a list in items; numbers ignore it.
struct FieldEntry {
  std::string_view name;
  std::ptrdiff_t offset = 0;  ///< in its struct, bytes
  const Shape* shape = nullptr;
  std::uint32_t max = kDefaultMaxSize;
};

/// The fields of a struct, in the order in which msgpack has them.
using FieldTable = std::vector<FieldEntry>;

template <class Owner, class Member>
FieldEntry field(std::string_view name, Member Owner::*member, std::uint32_t max = kDefaultMaxSize) {
  static_assert(std::is_standard_layout_v<Owner>, "only such a struct's fields have a place of their own in it");
  // A pointer to a data member is its offset: so says the Itanium ABI, which GCC and clang follow.
  return {name, std::bit_cast<std::ptrdiff_t>(member), &make_shape<Member>(), max};
}

/// A struct with a field list; it may be a body or a part of one.
template <class T>
concept Fielded = requires {
  T::fields();
};

/// An enum whose names are listed by `enum_names(E)`, in order of its values from 0.
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
