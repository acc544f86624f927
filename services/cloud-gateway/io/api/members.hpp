// The members of a request's body, read one by one.
#pragma once

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "services/cloud-gateway/io/api/call.hpp"

namespace trb::gateway {

/// Errors name the member: "/name: ...".
class Members {
 public:
  /// The body, which may have only these members. Errors: those of body_of(); bad_value (an unknown member).
  static Result<Members> of(const Call& call, std::initializer_list<std::string_view> names);
  /// The same for an object that is no body. Errors: bad_value.
  static Result<Members> of(Value json, std::initializer_list<std::string_view> names);

  [[nodiscard]] bool has(std::string_view name) const { return json_.find(name) != nullptr; }
  [[nodiscard]] Result<std::string> text(std::string_view name, std::size_t most) const;
  [[nodiscard]] Result<std::string> text_or(std::string_view name, std::size_t most, std::string otherwise) const;
  [[nodiscard]] Result<bool> flag_or(std::string_view name, bool otherwise) const;
  [[nodiscard]] Result<std::int64_t> number_or(std::string_view name, std::int64_t otherwise, std::int64_t from,
                                               std::int64_t to) const;
  /// A list of at most that many numbers. Errors: missing, bad_value, too_large.
  [[nodiscard]] Result<std::vector<double>> numbers(std::string_view name, std::size_t most) const;
  [[nodiscard]] const Value* value(std::string_view name) const { return json_.find(name); }

  /// One of an enumeration's names.
  template <class E>
  [[nodiscard]] Result<E> one_of(std::string_view name) const {
    const auto given = text(name, 64);
    if (!given) return given.error();
    std::string all;
    constexpr auto kNames = enum_names(E{});
    for (std::size_t i = 0; i < kNames.size(); ++i) {
      if (kNames[i] == *given) return static_cast<E>(i);
      all += (i == 0 ? "" : ", ") + std::string(kNames[i]);
    }
    return fail(Errc::bad_value, std::string(name) + ": '" + *given + "'", "use one of: " + all);
  }

 private:
  explicit Members(Value json) : json_(std::move(json)) {}
  Value json_;
};

/// The optional body {"reason": TEXT}; empty: none was given. Errors: those of Members::of() and text().
Result<std::string> reason_in(const Call& call, std::size_t most);
/// A reason with the name of who gives it, as others read it: "by olga: lunch". At most so many bytes.
std::string with_name(const Call& call, const std::string& reason, std::size_t most);

}  // namespace trb::gateway
