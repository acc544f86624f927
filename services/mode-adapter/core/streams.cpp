#include "services/mode-adapter/core/streams.hpp"

#include <algorithm>

#include "common/base/gives_way.hpp"
#include "proto/value.hpp"

namespace trb::adapter {
namespace {

constexpr std::size_t kMostStreams = 32;
constexpr std::size_t kLongestOrder = 256;
constexpr double kLongest_s = 3600;
constexpr double kShortestPause_s = 0.1;

Result<double> number(const Value& order, std::string_view key, double highest, double otherwise) {
  const Value* value = order.find(key);
  if (value == nullptr) return otherwise;
  if (value->is_number() && value->number() >= 0 && value->number() <= highest) return value->number();
  return fail(Errc::bad_value, std::string(key) + ": is no number of seconds from 0 to " + std::to_string(int(highest)),
              R"(write it like {"stream_s": 10, "every_s": 0.5})");
}

}  // namespace

Result<std::optional<StreamOrder>> read_stream_order(BytesView data) {
  const auto nothing = std::optional<StreamOrder>();
  if (data.size() > kLongestOrder || data.find("stream_s") == BytesView::npos) return nothing;
  const auto order = parse_json(data);
  if (!order || !order->is_object() || order->find("stream_s") == nullptr) return nothing;
  const auto for_s = number(*order, "stream_s", kLongest_s, 0);
  if (!for_s) return for_s.error();
  const auto every_s = number(*order, "every_s", kLongest_s, kShortestPause_s);
  if (!every_s) return every_s.error();
  return std::optional(StreamOrder{*for_s, std::max(*every_s, kShortestPause_s)});
}

Status Streams::add(std::string_view subtype, std::string_view source, Driver& mode, const StreamOrder& order,
                    Now now) {
  drop([&](const Stream& one) { return one.subtype == subtype && one.source == source; });
  if (order.for_s <= 0) return Done{};
  if (streams_.size() >= kMostStreams && !make_room(source)) {
    return fail(Errc::queue_full, "the robot tells 32 streams already", "wait until one of them ends");
  }
  const Duration every = seconds(order.every_s);
  streams_.push_back({std::string(subtype), std::string(source), &mode, every, now.mono + seconds(order.for_s),
                      now.mono + every, now.mono});
  return Done{};
}

bool Streams::make_room(std::string_view source) {
  const std::string other = gives_way(streams_, source, &Stream::source);
  if (other == source) return false;
  const auto newest =
      std::find_if(streams_.rbegin(), streams_.rend(), [&](const Stream& one) { return one.source == other; });
  drop([&, subtype = newest->subtype](const Stream& one) { return one.source == other && one.subtype == subtype; });
  return true;
}

void Streams::on_values(Driver& mode, Now now, Outbox& out) {
  for (Stream& stream : streams_) {
    if (stream.mode != &mode || now.mono < stream.next || now.mono > stream.until) continue;
    const RobotValue* value = mode.value(stream.subtype);
    if (value == nullptr || value->heard <= stream.told) continue;
    stream.told = value->heard;
    stream.next = now.mono + stream.every;
    out.count("streamed." + stream.subtype);
    out.information(stream.source, Opaque{stream.subtype, value->json});
  }
}

void Streams::on_link_down(const Driver& mode) {
  drop([&](const Stream& stream) { return stream.mode == &mode; });
}

void Streams::drop(const std::function<bool(const Stream&)>& is_over) {
  std::erase_if(streams_, [&](const Stream& stream) {
    if (!is_over(stream)) return false;
    ended_.push_back(stream.subtype);
    return true;
  });
}

std::vector<std::string> Streams::take_ended(Now now) {
  drop([&](const Stream& stream) { return now.mono >= stream.until; });
  std::erase_if(ended_, [&](const std::string& subtype) {
    return std::ranges::any_of(streams_, [&](const Stream& stream) { return stream.subtype == subtype; });
  });
  return std::exchange(ended_, {});
}

std::optional<MonotonicTime> Streams::next_deadline() const {
  std::optional<MonotonicTime> next;
  for (const Stream& stream : streams_) next = earlier(next, stream.until);
  return next;
}

}  // namespace trb::adapter
