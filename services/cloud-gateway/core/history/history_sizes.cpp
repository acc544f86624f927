#include "services/cloud-gateway/core/history/history_sizes.hpp"

#include <algorithm>

namespace trb::gateway {

void HistorySizes::add(const HistoryStream& stream, std::int64_t bytes) {
  Node& of = nodes_[stream.node];
  of.streams[stream.sensor] += bytes;
  of.bytes += bytes;
  bytes_ += bytes;
}

void HistorySizes::remove(const HistoryStream& stream, std::int64_t bytes) {
  const auto of = nodes_.find(stream.node);
  if (of == nodes_.end()) return;
  const auto at = of->second.streams.find(stream.sensor);
  if (at == of->second.streams.end()) return;
  bytes = std::min(bytes, at->second);
  at->second -= bytes;
  of->second.bytes -= bytes;
  bytes_ -= bytes;
  if (at->second == 0) of->second.streams.erase(at);
  if (of->second.streams.empty()) nodes_.erase(of);
}

void HistorySizes::forget(const HistoryStream& stream) {
  remove(stream, bytes_);
}

std::optional<HistoryStream> HistorySizes::over_share() const {
  const auto most = [](const auto& a, const auto& b) { return a.second.bytes < b.second.bytes; };
  const auto node = std::ranges::max_element(nodes_, most);
  if (node == nodes_.end()) return std::nullopt;
  const std::int64_t share = std::min(bytes_ / 2, 2 * (bytes_ / static_cast<std::int64_t>(nodes_.size())));
  if (node->second.bytes <= share) return std::nullopt;
  const auto stream =
      std::ranges::max_element(node->second.streams, [](const auto& a, const auto& b) { return a.second < b.second; });
  return HistoryStream{node->first, stream->first};
}

}  // namespace trb::gateway
