#include "services/cli/core/sequence_chart.hpp"

#include <algorithm>
#include <cstdio>

namespace trb::cli {
namespace {

constexpr std::size_t kLeastColumn = 12;
constexpr std::size_t kMargin = 6;  ///< around a label: its arrow
const std::string kToAll = "*";

std::vector<std::string> columns_of(const std::vector<ChartRow>& rows, const std::vector<std::string>& nodes) {
  std::vector<std::string> met;
  const auto meet = [&](const std::string& id) {
    if (id != kToAll && std::ranges::find(met, id) == met.end()) met.push_back(id);
  };
  for (const ChartRow& row : rows) {
    meet(row.from);
    meet(row.to);
  }
  std::vector<std::string> out;
  for (const std::string& id : nodes) {
    if (std::ranges::find(met, id) != met.end()) out.push_back(id);
  }
  for (const std::string& id : met) {
    if (std::ranges::find(out, id) == out.end()) out.push_back(id);
  }
  return out;
}

std::size_t width_for(const std::vector<ChartRow>& rows, const std::vector<std::string>& columns) {
  std::size_t out = kLeastColumn;
  for (const ChartRow& row : rows) out = std::max(out, row.label.size() + kMargin);
  for (const std::string& id : columns) out = std::max(out, id.size() + 2);
  return out;
}

/// A lifeline at each column's begin.
std::string lifelines(std::size_t columns, std::size_t width) {
  std::string out(columns * width, ' ');
  for (std::size_t i = 0; i < columns; ++i) out[i * width] = '|';
  return out;
}

void draw_arrow(std::string& line, std::size_t from, std::size_t to, const std::string& label) {
  const std::size_t left = std::min(from, to) + 1, right = std::max(from, to);  // right: behind the last one
  std::fill(line.begin() + static_cast<std::ptrdiff_t>(left), line.begin() + static_cast<std::ptrdiff_t>(right), '-');
  from < to ? line[right - 1] = '>' : line[left] = '<';
  line.replace(left + (right - left - label.size() - 2) / 2, label.size() + 2, " " + label + " ");
}

std::string drawn(const ChartRow& row, const std::vector<std::string>& columns, std::size_t width) {
  const auto place = [&](const std::string& id) {
    return static_cast<std::size_t>(std::ranges::find(columns, id) - columns.begin()) * width;
  };
  std::string line = lifelines(columns.size(), width);
  const std::size_t from = place(row.from);
  if (row.to != kToAll && row.to != row.from) {
    draw_arrow(line, from, place(row.to), row.label);
  } else {
    const std::string text = (row.to == kToAll ? "o--> all: " : "* ") + row.label;
    line.resize(std::max(line.size(), from + text.size()), ' ');
    line.replace(from, text.size(), text);
  }
  line.erase(line.find_last_not_of(' ') + 1);
  return line;
}

std::string heading(const std::vector<std::string>& columns, std::size_t width) {
  std::string out = "     TIME    EVENT  ";
  for (const std::string& id : columns) out += id + std::string(width - id.size(), ' ');
  out.erase(out.find_last_not_of(' ') + 1);
  return out + "\n";
}

}  // namespace

std::string sequence_chart(const std::vector<ChartRow>& rows, const std::vector<std::string>& nodes) {
  if (rows.empty()) return "";
  const std::vector<std::string> columns = columns_of(rows, nodes);
  const std::size_t width = width_for(rows, columns);
  std::string out = heading(columns, width);
  for (const ChartRow& row : rows) {
    char before[48];
    std::snprintf(before, sizeof before, "%9.4f %8llu  ", row.at_s, static_cast<unsigned long long>(row.event));
    out += before + drawn(row, columns, width) + "\n";
  }
  return out;
}

}  // namespace trb::cli
