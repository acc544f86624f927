#include "services/resilience/core/fleet_index.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <functional>

namespace trb::resilience {
namespace {

constexpr std::size_t kBits = 64;
/// Words that are ANDed at a time: 2 kB of a row, so that the results stay in the first cache.
constexpr std::size_t kBlock = 256;

void push_robots(std::uint64_t bits, std::size_t word, std::vector<RobotNumber>& out) {
  for (; bits != 0; bits &= bits - 1) {
    out.push_back(static_cast<RobotNumber>(word * kBits + static_cast<std::size_t>(std::countr_zero(bits))));
  }
}

}  // namespace

Result<RobotNumber> FleetIndex::add(std::string_view id) {
  if (const auto known = find(id)) return *known;
  if (numbers_.size() >= kMaxRobots) {
    return fail(Errc::too_large, "the index has its " + std::to_string(kMaxRobots) + " robots");
  }
  RobotNumber number = static_cast<RobotNumber>(robots_.size());
  if (free_robots_.empty()) {
    robots_.emplace_back();
    measures_.emplace_back();
  } else {
    std::pop_heap(free_robots_.begin(), free_robots_.end(), std::greater<>());
    number = free_robots_.back();
    free_robots_.pop_back();
  }
  robots_[number].id = id;
  measures_[number] = {};
  set_bit(present_, number);
  numbers_.emplace(id, number);
  return number;
}

void FleetIndex::drop(std::string_view id) {
  const auto at = numbers_.find(id);
  if (at == numbers_.end()) return;
  const RobotNumber number = at->second;
  set_words(number, {});
  present_.bits[number / kBits] &= ~(std::uint64_t{1} << (number % kBits));
  robots_[number] = {};
  numbers_.erase(at);
  free_robots_.push_back(number);
  std::push_heap(free_robots_.begin(), free_robots_.end(), std::greater<>());
}

std::optional<RobotNumber> FleetIndex::find(std::string_view id) const {
  const auto at = numbers_.find(id);
  return at == numbers_.end() ? std::nullopt : std::optional(at->second);
}

FleetIndex::RowNumber FleetIndex::row_of(const std::string& word) {
  if (const auto at = words_.find(word); at != words_.end()) return at->second;
  RowNumber number = static_cast<RowNumber>(rows_.size());
  if (free_rows_.empty()) {
    rows_.emplace_back();
  } else {
    number = free_rows_.back();
    free_rows_.pop_back();
  }
  rows_[number].word = word;
  words_.emplace(word, number);
  return number;
}

void FleetIndex::set_bit(Row& row, RobotNumber robot) {
  const std::size_t word = robot / kBits;
  if (row.bits.size() <= word) row.bits.resize(word + 1);
  row.bits[word] |= std::uint64_t{1} << (robot % kBits);
  ++row.robots;
}

void FleetIndex::clear_bit(RowNumber number, RobotNumber robot) {
  Row& row = rows_[number];
  row.bits[robot / kBits] &= ~(std::uint64_t{1} << (robot % kBits));
  if (--row.robots > 0) return;
  // A word that is true of no robot frees its memory: words come from outside.
  words_.erase(row.word);
  row = {};
  free_rows_.push_back(number);
}

void FleetIndex::set_words(RobotNumber robot, const std::vector<std::string>& words) {
  std::vector<RowNumber> wanted;
  wanted.reserve(words.size());
  for (const std::string& word : words) wanted.push_back(row_of(word));
  std::sort(wanted.begin(), wanted.end());
  wanted.erase(std::unique(wanted.begin(), wanted.end()), wanted.end());
  std::vector<RowNumber>& have = robots_[robot].rows;
  std::vector<RowNumber> changed;
  std::set_difference(wanted.begin(), wanted.end(), have.begin(), have.end(), std::back_inserter(changed));
  for (const RowNumber row : changed) set_bit(rows_[row], robot);
  changed.clear();
  std::set_difference(have.begin(), have.end(), wanted.begin(), wanted.end(), std::back_inserter(changed));
  for (const RowNumber row : changed) clear_bit(row, robot);
  have = std::move(wanted);
}

bool FleetIndex::has(RobotNumber robot, std::string_view word) const {
  const auto at = words_.find(word);
  return at != words_.end() && std::binary_search(robots_[robot].rows.begin(), robots_[robot].rows.end(), at->second);
}

void FleetIndex::query(std::span<const std::string> words, std::vector<RobotNumber>& out) const {
  out.clear();
  std::vector<const Row*> rows;
  for (const std::string& word : words) {
    const auto at = words_.find(word);
    if (at == words_.end()) return;
    rows.push_back(&rows_[at->second]);
  }
  if (rows.empty()) rows.push_back(&present_);
  std::size_t size = rows.front()->bits.size();
  for (const Row* row : rows) size = std::min(size, row->bits.size());
  std::array<std::uint64_t, kBlock> sum{};
  for (std::size_t begin = 0; begin < size; begin += kBlock) {
    const std::size_t length = std::min(kBlock, size - begin);
    std::copy_n(rows.front()->bits.data() + begin, length, sum.data());
    for (std::size_t r = 1; r < rows.size(); ++r) {
      const std::uint64_t* bits = rows[r]->bits.data() + begin;
      for (std::size_t i = 0; i < length; ++i) sum[i] &= bits[i];
    }
    for (std::size_t i = 0; i < length; ++i) push_robots(sum[i], begin + i, out);
  }
}

}  // namespace trb::resilience
