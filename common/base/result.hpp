// Result<T>: a value or an Error. Expected failures are values; exceptions are for starting up only.
#pragma once

#include <cassert>
#include <string>
#include <string_view>
#include <utility>
#include <variant>

#include "common/base/errc.hpp"

namespace trb {

/// What went wrong, in which field, and what to do about it.
struct Error {
  Errc code = Errc::ok;
  std::string what;  ///< names the field: "network.json: TCP_PORT: 70000 is no port"
  std::string hint;  ///< what to do: "use a number from 1 to 65535"; may be empty

  /// "code: what; cure"
  [[nodiscard]] std::string text() const {
    std::string out(errc_name(code));
    if (!what.empty()) out += ": " + what;
    if (!hint.empty()) out += "; " + hint;
    return out;
  }
};

template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : state_(std::in_place_index<0>, std::move(value)) {}      // NOLINT(google-explicit-constructor)
  Result(Error error) : state_(std::in_place_index<1>, std::move(error)) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] bool ok() const { return state_.index() == 0; }
  explicit operator bool() const { return ok(); }

  T& operator*() & { return value(); }
  const T& operator*() const& { return value(); }
  T&& operator*() && { return std::move(value()); }
  T* operator->() { return &value(); }
  const T* operator->() const { return &value(); }

  T& value() {
    assert(ok());
    return std::get<0>(state_);
  }
  const T& value() const {
    assert(ok());
    return std::get<0>(state_);
  }
  [[nodiscard]] const Error& error() const {
    assert(!ok());
    return std::get<1>(state_);
  }

 private:
  std::variant<T, Error> state_;
};

/// Success without a value.
struct Done {};
using Status = Result<Done>;

inline Error fail(Errc code, std::string what, std::string hint = {}) {
  return Error{code, std::move(what), std::move(hint)};
}

}  // namespace trb
