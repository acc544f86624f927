#include "common/fleet/did_you_mean.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace trb {
namespace {

constexpr std::size_t kMostEdits = 2;
constexpr std::size_t kLongestWord = 64;
constexpr std::size_t kMostListed = 40;

/// Edits from one to the other: a letter more, less or another, or two neighbours exchanged (the commonest slip).
/// Optimal string alignment, https://en.wikipedia.org/wiki/Damerau-Levenshtein_distance.
std::size_t edits(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> last(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::swap(before, last);
    std::swap(last, row);
    row[0] = i;
    for (std::size_t k = 1; k <= b.size(); ++k) {
      const std::size_t replaced = last[k - 1] + (a[i - 1] == b[k - 1] ? 0U : 1U);
      row[k] = std::min({replaced, last[k] + 1, row[k - 1] + 1});
      const bool exchanged = i > 1 && k > 1 && a[i - 1] == b[k - 2] && a[i - 2] == b[k - 1];
      if (exchanged) row[k] = std::min(row[k], before[k - 2] + 1);
    }
  }
  return row[b.size()];
}

}  // namespace

std::string nearest(std::string_view word, const std::vector<std::string>& candidates) {
  std::string best;
  // Two edits turn any two-letter word into any other: a guess must keep half of the word.
  std::size_t fewest = std::min(kMostEdits, word.size() / 2) + 1;
  if (word.size() > kLongestWord) return best;
  for (const std::string& candidate : candidates) {
    if (candidate.size() > word.size() + kMostEdits || word.size() > candidate.size() + kMostEdits) continue;
    const std::size_t distance = edits(word, candidate);
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
