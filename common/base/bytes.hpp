// Bytes travel in std::string: one buffer type from socket to database, movable and cheap when short.
#pragma once

#include <string>
#include <string_view>

namespace trb {

using Bytes = std::string;
using BytesView = std::string_view;

/// Lets a std::variant be visited with one lambda for each type.
template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace trb
