// Bytes travel in std::string: one buffer type from socket to database, movable and cheap when short.
#pragma once

#include <string>
#include <string_view>

namespace trb {

using Bytes = std::string;
using BytesView = std::string_view;

/// Lets one lambda a type visit a std::variant.
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace trb
