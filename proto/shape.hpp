// The structure of a body as data: one codec walks it, so that none has to be compiled for each body.
#pragma once

#include <cstddef>
#include <span>
#include <string_view>

#include "proto/field.hpp"

namespace trb {

/// The type of a field, or of an item of a list.
enum class FieldKind : std::uint8_t {
  boolean = 0,
  enumeration,  ///< of one byte
  uint16,
  uint32,
  uint64,
  int64,
  number,  ///< double
  text,    ///< std::string
  blob,
  list,   ///< std::vector
  record  ///< a struct with fields
};

/// How code that does not know a std::vector's item type handles it.
struct ListShape {
  const Shape* item = nullptr;
  std::ptrdiff_t stride = 0;  ///< sizeof an item
  std::size_t (*size)(const void* list) = nullptr;
  const void* (*data)(const void* list) = nullptr;
  void* (*renew)(void* list, std::size_t size) = nullptr;  ///< resizes it to that many new items; returns the first
};

/// Made once for each type, and never changed.
struct Shape {
  FieldKind kind = FieldKind::boolean;
  std::span<const std::string_view> names{};  ///< of an enumeration
  ListShape list{};                           ///< of a list
  std::span<const FieldEntry> fields{};       ///< of a record
};

/// A value, with the shape that gives its type.
template <class T>
const T& as(const void* value) {
  return *static_cast<const T*>(value);
}
template <class T>
T& as(void* value) {
  return *static_cast<T*>(value);
}

/// The number of an enumeration or of one of the unsigned kinds.
inline std::uint64_t unsigned_of(FieldKind kind, const void* value) {
  if (kind == FieldKind::enumeration) return as<std::uint8_t>(value);
  if (kind == FieldKind::uint16) return as<std::uint16_t>(value);
  return kind == FieldKind::uint32 ? as<std::uint32_t>(value) : as<std::uint64_t>(value);
}

/// The address of a field at its offset, or of a list's item.
inline const void* behind(const void* at, std::ptrdiff_t bytes) {
  return static_cast<const char*>(at) + bytes;
}
inline void* behind(void* at, std::ptrdiff_t bytes) {
  return static_cast<char*>(at) + bytes;
}

}  // namespace trb
