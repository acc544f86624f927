// What a core takes, in one list: the list of subtypes is made from it, and each must have a handler.
#pragma once

#include <string>
#include <vector>

#include "proto/body.hpp"

namespace trb {

template <IsBody... Bodies>
struct Takes {
  /// For Service::open.
  static std::vector<std::string> subtypes() { return {std::string(Bodies::kSubtype)...}; }

  /// Calls the handler with the body's struct; false: the body is none of these. A body without a handler does not
  /// compile.
  template <class Handler>
  static bool dispatch(const Body& body, Handler&& handler) {
    const auto try_one = [&](const auto* one) {
      if (one != nullptr) handler(*one);
      return one != nullptr;
    };
    return (try_one(get_if<Bodies>(&body)) || ...);
  }
};

}  // namespace trb
