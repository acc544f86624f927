// Fills any body with values that are not the defaults, and compares two of them.
#pragma once

#include <span>
#include <string_view>

#include "proto/body.hpp"

namespace trb::contract {

/// A body of the list and its codecs, without its type: the tests of all bodies are compiled once, not a hundred times.
struct AnyBody {
  std::string_view subtype;
  BodyKind kind;
  Bytes (*encode)(const Body&);
  Result<Body> (*decode)(BytesView);
  std::string (*to_json)(const Body&);
  Result<Body> (*from_json)(std::string_view);
};

/// Every body.
std::span<const AnyBody> every_body();

/// Every field has a value other than the default, every list two items.
Body filled(BodyKind kind);

/// Are they of the same kind, and equal field by field?
bool same(const Body& a, const Body& b);

}  // namespace trb::contract
