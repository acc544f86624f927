// Messages between nodes as a sequence chart in text: a column for each node, time goes down.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace trb::cli {

struct ChartRow {
  double at_s = 0;
  std::uint64_t event = 0;
  std::string from;
  std::string to;     ///< the same as `from`: within that node; "*": to all
  std::string label;  ///< what is sent
};

/// A line for each row, below a heading with the nodes. The columns are those nodes that have a part, in the order of
/// `nodes`, then the others by their first row.
std::string sequence_chart(const std::vector<ChartRow>& rows, const std::vector<std::string>& nodes = {});

}  // namespace trb::cli
