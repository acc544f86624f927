#include "common/fleet/did_you_mean.hpp"

#include <algorithm>
#include <array>
#include <utility>
#include <vector>

namespace trb {
namespace {

constexpr std::size_t kMostEdits = 2;
constexpr std::size_t kLongestWord = 64;
constexpr std::size_t kMostListed = 40;

/// Edits from one to the other: a letter more, less or another, or two neighbours exchanged (the commonest slip);
/// `most` + 1 if there are more than `most`. `a` has at most kLongestWord bytes, `most` is at most kMostEdits.
/// Optimal string alignment, https://en.wikipedia.org/wiki/Damerau-Levenshtein_distance. Of its table only the cells
/// that may hold so few are filled in, and no more rows once one has none: a stranger's file may have hundreds of wrong
/// words, with a thousand candidates for each.
std::size_t edits(std::string_view a, std::string_view b, std::size_t most) {
  const std::size_t over = most + 1;
  if (b.size() > a.size() + most || a.size() > b.size() + most) return over;
  std::array<std::array<std::size_t, kLongestWord + kMostEdits + 1>, 3> rows{};
  for (std::size_t k = 0; k <= b.size(); ++k) rows[0][k] = k;
  std::size_t fewest_before = 0;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    const auto& before = rows[(i + 1) % 3];
    const auto& last = rows[(i + 2) % 3];
    auto& row = rows[i % 3];
    const std::size_t from = i > most ? i - most : 1;
    const std::size_t to = std::min(b.size(), i + most);
    row[from - 1] = from == 1 ? i : over;
    std::size_t fewest = row[from - 1];
    for (std::size_t k = from; k <= to; ++k) {
      const std::size_t replaced = last[k - 1] + (a[i - 1] == b[k - 1] ? 0U : 1U);
      row[k] = std::min({replaced, last[k] + 1, row[k - 1] + 1});
      const bool exchanged = i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1];
      if (exchanged) row[k] = std::min(row[k], before[k - 2] + 1);
      fewest = std::min(fewest, row[k]);
    }
    if (to < b.size()) row[to + 1] = over;
    // Two letters exchanged lead from the row before.
    if (fewest > most && fewest_before >= most) return over;
    fewest_before = fewest;
  }
  return std::min(rows[a.size() % 3][b.size()], over);
}

}  // namespace

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  // Two edits turn any two-letter word into any other: a guess must keep half of the word.
  std::size_t fewest = std::min(kMostEdits, word.size() / 2) + 1;
  if (word.size() > kLongestWord) return best;
  for (const std::string& candidate : candidates) {
    if (fewest == 0) break;
    const std::size_t distance = edits(word, candidate, fewest - 1);
    if (distance < fewest) {
      fewest = distance;
      best = candidate;
    }
  }
  return best;
}

std::string did_you_mean(std::string_view word, const std::vector<std::string>& candidates,
                         std::string_view otherwise) {
  const std::string guess = nearest(word, candidates);
  if (!guess.empty()) return "did you mean '" + guess + "'?";
  std::string out(otherwise);
  if (!candidates.empty()) out += ": " + join(candidates);
  return out;
}

std::string join(const std::vector<std::string>& words) {
  std::string out;
  for (std::size_t i = 0; i < words.size() && i < kMostListed; ++i) out += (i == 0 ? "" : ", ") + words[i];
  if (words.size() > kMostListed) out += ", …";
  return out;
}

std::string in_quotes(std::string_view text) {
  if (text.size() <= kLongestWord) return "'" + std::string(text) + "'";
  std::size_t end = kLongestWord;
  while (end > 0 && (static_cast<unsigned char>(text[end]) & 0xC0U) == 0x80U) --end;  // never cut a character
  return "'" + std::string(text.substr(0, end)) + "…'";
}

}  // namespace trb
