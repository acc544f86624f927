// Makes the shape of a struct from its field list.
#pragma once

#include <type_traits>

#include "proto/shape.hpp"

namespace trb {

template <class T>
constexpr FieldKind plain_kind() {
  if constexpr (std::is_same_v<T, bool>) {
    return FieldKind::boolean;
  } else if constexpr (std::is_same_v<T, std::uint16_t>) {
    return FieldKind::uint16;
  } else if constexpr (std::is_same_v<T, std::uint32_t>) {
    return FieldKind::uint32;
  } else if constexpr (std::is_same_v<T, std::uint64_t>) {
    return FieldKind::uint64;
  } else if constexpr (std::is_same_v<T, std::int64_t>) {
    return FieldKind::int64;
  } else if constexpr (std::is_same_v<T, double>) {
    return FieldKind::number;
  } else if constexpr (std::is_same_v<T, std::string>) {
    return FieldKind::text;
  } else {
    static_assert(std::is_same_v<T, Blob>, "a field of this type has no codec: see FieldKind");
    return FieldKind::blob;
  }
}

template <class T>
const Shape& make_enumeration() {
  static_assert(sizeof(T) == 1, "an enumeration travels as one byte");
  static constexpr auto kNames = enum_names(T{});
  static constexpr Shape kShape{.kind = FieldKind::enumeration, .names = kNames};
  return kShape;
}

template <class List>
const Shape& make_list() {
  using Item = typename List::value_type;
  static const Shape shape{
      .kind = FieldKind::list,
      .list = {.item = &make_shape<Item>(),
               .stride = sizeof(Item),
               .size = [](const void* at) { return static_cast<const List*>(at)->size(); },
               .data = [](const void* at) -> const void* { return static_cast<const List*>(at)->data(); },
               .renew = [](void* at, std::size_t size) -> void* {
                 auto& list = *static_cast<List*>(at);
                 list.clear();
                 list.resize(size);
                 return list.data();
               }}};
  return shape;
}

template <class T>
const Shape& make_record() {
  static const FieldTable fields = T::fields();
  static const Shape shape{.kind = FieldKind::record, .fields = fields};
  return shape;
}

template <class T>
const Shape& make_shape() {
  if constexpr (std::is_enum_v<T>) {
    return make_enumeration<T>();
  } else if constexpr (IsVector<T>::value) {
    return make_list<T>();
  } else if constexpr (Fielded<T>) {
    return make_record<T>();
  } else {
    static constexpr Shape kShape{.kind = plain_kind<T>()};
    return kShape;
  }
}

}  // namespace trb
