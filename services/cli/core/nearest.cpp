#include "services/cli/core/nearest.hpp"

#include <algorithm>

namespace trb::cli {
namespace {

constexpr std::size_t kLongest = 64;  // no word of trb's is as long
constexpr std::size_t kShare = 3;

}  // namespace

std::size_t edits_between(std::string_view a, std::string_view b) {
  std::vector<std::size_t> before(b.size() + 1);
  std::vector<std::size_t> above(b.size() + 1);
  std::vector<std::size_t> row(b.size() + 1);
  for (std::size_t j = 0; j <= b.size(); ++j) above[j] = j;
  for (std::size_t i = 1; i <= a.size(); ++i) {
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t other = a[i - 1] == b[j - 1] ? 0 : 1;
      row[j] = std::min({above[j] + 1, row[j - 1] + 1, above[j - 1] + other});
      const bool swapped = i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1];
      if (swapped) row[j] = std::min(row[j], before[j - 2] + 1);
    }
    before.swap(above);
    above.swap(row);
  }
  return above[b.size()];
}

std::string nearest(std::string_view given, const std::vector<std::string>& known) {
  std::string best;
  if (given.size() > kLongest) return best;
  std::size_t least = kLongest;
  for (const std::string& word : known) {
    const std::size_t edits = edits_between(given, word);
    if (edits > std::max<std::size_t>(1, word.size() / kShare) || edits >= word.size() || edits >= least) continue;
    least = edits;
    best = word;
  }
  return best;
}

}  // namespace trb::cli
