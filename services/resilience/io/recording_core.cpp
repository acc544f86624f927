#include "services/resilience/io/recording_core.hpp"

#include <algorithm>

namespace trb::resilience {
namespace {

constexpr Duration kTogether = std::chrono::seconds(3);

}  // namespace

RecordingCore::RecordingCore(ResilienceCore& core, CapabilityDb& db) : core_(core), db_(db) {
  if (const auto newest = db_.history("", 1); newest && !newest->empty()) steady_.restore(newest->front().time);
}

void RecordingCore::on_welcome(const NodeIdentity& node, Now now, Outbox& out) {
  core_.on_welcome(node, now, out);
  keep(now, out);
}

void RecordingCore::on(const Inbound& message, Now now, Outbox& out) {
  core_.on(message, now, out);
  keep(now, out);
}

void RecordingCore::tick(Now now, Outbox& out) {
  if (const auto next = core_.next_deadline(); next && *next <= now.mono) core_.tick(now, out);
  keep(now, out);
}

std::optional<MonotonicTime> RecordingCore::next_deadline() const {
  return earlier(core_.next_deadline(), write_at_);
}

Status RecordingCore::flush(Now now) {
  // A line may have been written while the clock was ahead: then the clock is the one to go by.
  return db_.write(core_.fleet(), std::min(steady_.at(now), now.utc));
}

/// A failing disk does not block requests: the changes wait.
void RecordingCore::keep(Now now, Outbox& out) {
  steady_.at(now);
  const Changes& changes = core_.fleet().changes();
  if (changes.empty()) {
    write_at_.reset();
    return;
  }
  if (!write_at_) write_at_ = now.mono + kTogether;
  const bool at_once = changes.urgent() && !failed_;
  if (!at_once && *write_at_ > now.mono) return;
  const Status written = flush(now);
  failed_ = !written.ok();
  write_at_ = failed_ ? std::optional(now.mono + kTogether) : std::nullopt;
  if (!failed_) return;
  out.count("not_written");
  out.log(LogLevel::error, "fleet_not_written", written.error().text());
}

}  // namespace trb::resilience
