// How an operation ends: a call with its result. It is never made before the call that began the operation returns.
#pragma once

#include <functional>
#include <utility>

#include "common/base/result.hpp"

namespace trb::op {

template <class T>
using Callback = std::function<void(Result<T>)>;

/// For a step of an operation: `next` continues with the value, an error ends the operation.
template <class T, class Out, class Next>
Callback<T> on_success(Callback<Out> done, Next next) {
  return [done = std::move(done), next = std::move(next)](Result<T> result) {
    if (!result) return done(result.error());
    next(std::move(*result));
  };
}

}  // namespace trb::op
