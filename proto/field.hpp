// How a body names its fields, once: both codecs (msgpack, JSON) are made from the list.
#pragma once

#include <array>
#include <concepts>
#include <cstdint>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

namespace trb {

/// Bytes that are no text: msgpack bin, hexadecimal in JSON.
struct Blob {
  std::string bytes;
  bool operator==(const Blob&) const = default;
};

constexpr std::uint32_t kDefaultMaxSize = 255;

/// One field of a body. `max` bounds a text or blob in bytes and a list in items; numbers ignore it.
template <class Owner, class Member>
struct Field {
  std::string_view name;
  Member Owner::*member;
  std::uint32_t max = kDefaultMaxSize;
};

template <class Owner, class Member>
constexpr Field<Owner, Member> field(std::string_view name, Member Owner::*member,
                                     std::uint32_t max = kDefaultMaxSize) {
  return {name, member, max};
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
