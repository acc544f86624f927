// Fills any body through its field list with values that are not the defaults, and compares two of them.
#pragma once

#include <string>

#include "proto/body.hpp"

namespace trb::contract {

class Filler {
 public:
  template <class T>
  T make() {
    T out{};
    fill(out, 64);
    return out;
  }

 private:
  template <class T>
  void fill(T& out, std::uint32_t max) {
    ++count_;
    if constexpr (std::is_same_v<T, bool>) {
      out = !out;
    } else if constexpr (std::is_enum_v<T>) {
      out = static_cast<T>(enum_names(T{}).size() - 1);
    } else if constexpr (std::is_floating_point_v<T>) {
      out = 0.25 + count_;
    } else if constexpr (std::is_integral_v<T>) {
      out = static_cast<T>(100 + count_);
      if constexpr (std::is_same_v<T, std::uint64_t>) out = ~std::uint64_t{0} - static_cast<std::uint64_t>(count_);
      if constexpr (std::is_same_v<T, std::int64_t>) out = -1'772'366'400'000'000'000 - count_;
    } else if constexpr (std::is_same_v<T, std::string>) {
      out = ("Zoë" + std::to_string(count_)).substr(0, max);
    } else if constexpr (std::is_same_v<T, Blob>) {
      out.bytes = std::string("\x00\xff\x80", 3) + static_cast<char>(count_);
    } else if constexpr (IsVector<T>::value) {
      for (int i = 0; i < 2; ++i) fill(out.emplace_back(), kDefaultMaxSize);
    } else {
      std::apply([&](const auto&... f) { (fill(out.*(f.member), f.max), ...); }, T::fields());
    }
  }

  int count_ = 0;
};

template <class T>
bool same(const T& a, const T& b) {
  if constexpr (IsVector<T>::value) {
    bool all = a.size() == b.size();
    for (std::size_t i = 0; all && i < a.size(); ++i) all = same(a[i], b[i]);
    return all;
  } else if constexpr (Fielded<T>) {
    return std::apply([&](const auto&... f) { return (same(a.*(f.member), b.*(f.member)) && ...); }, T::fields());
  } else {
    return a == b;
  }
}

/// Calls visit.template operator()<T>() for every body.
template <class Visit>
void each_body(Visit visit) {
#define TRB_VISIT(Name) visit.template operator()<Name>();
  TRB_BODIES(TRB_VISIT)
#undef TRB_VISIT
}

}  // namespace trb::contract
