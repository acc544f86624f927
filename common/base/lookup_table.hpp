// Rows by key for those who only look them up: nothing can be listed, so its order, which differs between machines,
// cannot matter to anybody.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

namespace trb {

constexpr std::uint64_t spread(std::uint64_t key) {
  key ^= key >> 32U;
  key *= 0x9E3779B97F4A7C15U;
  return key ^ key >> 29U;
}
/// FNV-1a.
constexpr std::uint64_t spread(std::string_view key) {
  std::uint64_t out = 0xCBF29CE484222325U;
  for (const char byte : key) out = (out ^ static_cast<unsigned char>(byte)) * 0x100000001B3U;
  return spread(out);
}

/// Where in a list that never changes a word stands; made by the compiler.
template <std::size_t N>
class WordIndex {
 public:
  static constexpr std::size_t kNone = N;

  /// `words`: no two of them are equal.
  constexpr explicit WordIndex(const std::array<std::string_view, N>& words) : words_(words) {
    for (std::size_t i = 0; i < N; ++i) places_[place_of(words[i])] = static_cast<std::uint16_t>(i + 1);
  }
  /// kNone: it is none of them.
  [[nodiscard]] constexpr std::size_t find(std::string_view word) const {
    const std::size_t at = places_[place_of(word)];
    return at == 0 ? kNone : at - 1;
  }

 private:
  /// Where it is, or could be.
  [[nodiscard]] constexpr std::size_t place_of(std::string_view word) const {
    std::size_t at = spread(word) & (kPlaces - 1);
    while (places_[at] != 0 && words_[places_[at] - 1U] != word) at = (at + 1) & (kPlaces - 1);
    return at;
  }

  static constexpr std::size_t kPlaces = std::bit_ceil(2 * N + 1);
  std::array<std::string_view, N> words_;
  std::array<std::uint16_t, kPlaces> places_{};  ///< 0: free; otherwise a word's number, from 1
};

/// Points at rows that somebody else owns, with keys that live as long as they do. At most half of it is in use.
template <class Key, class Row>
class LookupTable {
 public:
  /// nullptr: there is none.
  [[nodiscard]] Row* find(const Key& key) const {
    if (places_.empty()) return nullptr;
    return places_[place_of(key)].row;
  }
  void set(const Key& key, Row& row) {
    if (2 * (count_ + 1) > places_.size()) grow();
    Place& place = places_[place_of(key)];
    if (place.row == nullptr) ++count_;
    place = {key, &row};
  }
  void erase(const Key& key) {
    if (find(key) == nullptr) return;
    std::size_t hole = place_of(key);
    places_[hole] = {};
    --count_;
    // Whoever was pushed past the hole by others is moved back, or nobody would find it.
    for (std::size_t at = next(hole); places_[at].row != nullptr; at = next(at)) {
      const std::size_t home = spread(places_[at].key) & (places_.size() - 1);
      if (distance(home, at) < distance(hole, at)) continue;
      places_[hole] = places_[at];
      places_[at] = {};
      hole = at;
    }
  }

 private:
  struct Place {
    Key key{};
    Row* row = nullptr;
  };
  [[nodiscard]] std::size_t next(std::size_t at) const { return (at + 1) & (places_.size() - 1); }
  [[nodiscard]] std::size_t distance(std::size_t from, std::size_t to) const {
    return (to - from) & (places_.size() - 1);
  }
  /// Where it is, or could be.
  [[nodiscard]] std::size_t place_of(const Key& key) const {
    std::size_t at = spread(key) & (places_.size() - 1);
    while (places_[at].row != nullptr && places_[at].key != key) at = next(at);
    return at;
  }
  void grow() {
    const std::vector<Place> before =
        std::exchange(places_, std::vector<Place>(places_.empty() ? 8 : 2 * places_.size()));
    for (const Place& one : before) {
      if (one.row != nullptr) places_[place_of(one.key)] = one;
    }
  }

  std::vector<Place> places_;  ///< a power of two of them
  std::size_t count_ = 0;
};

}  // namespace trb
