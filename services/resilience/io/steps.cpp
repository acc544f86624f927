#include "services/resilience/io/steps.hpp"

namespace trb::resilience {
namespace {

constexpr Duration kTogether = std::chrono::seconds(3);
constexpr std::uint32_t kMostEvents = 500;  ///< as many as a HistoryTable holds

}  // namespace

std::vector<std::string> Steps::subtypes() {
  std::vector<std::string> out = ResilienceCore::Taken::subtypes();
  out.emplace_back(HistoryListRequest::kSubtype);
  return out;
}

void Steps::on_welcome(const NodeIdentity& node, Now now, Outbox& out) {
  core_.on_welcome(node, now, out);
  keep(now, out);
}

void Steps::on(const Inbound& message, Now now, Outbox& out) {
  const auto* asked = get_if<HistoryListRequest>(&message.body);
  if (asked != nullptr && message.type == MessageType::request) return tell_history(*asked, message, out);
  core_.on(message, now, out);
  keep(now, out);
}

void Steps::tick(Now now, Outbox& out) {
  if (const auto next = core_.next_deadline(); next && *next <= now.mono) core_.tick(now, out);
  keep(now, out);
}

std::optional<MonotonicTime> Steps::next_deadline() const {
  return earlier(core_.next_deadline(), write_at_);
}

void Steps::tell_history(const HistoryListRequest& asked, const Inbound& from, Outbox& out) {
  if (asked.most == 0 || asked.most > kMostEvents) {
    return out.nack(from, fail(Errc::bad_value, "most: " + std::to_string(asked.most), "use 1 to 500"));
  }
  const auto entries = db_.history(asked.robot, asked.most);
  if (!entries) return out.nack(from, entries.error());
  if (entries->empty() && !asked.robot.empty() && core_.fleet().find(asked.robot) == nullptr) {
    return out.nack(from, fail(Errc::unknown_target, "'" + asked.robot + "' was never heard", "trb robot list"));
  }
  HistoryTable table;
  for (const HistoryEntry& one : *entries) table.events.push_back({one.time.ns, one.robot, one.kind, one.text});
  out.reply(from, std::move(table));
}

/// A disk that takes nothing keeps nobody from asking: the changes wait.
void Steps::keep(Now now, Outbox& out) {
  const Changes& changes = core_.fleet().changes();
  if (changes.empty()) {
    write_at_.reset();
    return;
  }
  if (!write_at_) write_at_ = now.mono + kTogether;
  const bool at_once = changes.urgent() && !failed_;
  if (!at_once && *write_at_ > now.mono) return;
  const Status written = db_.write(core_.fleet(), now.utc);
  failed_ = !written.ok();
  write_at_ = failed_ ? std::optional(now.mono + kTogether) : std::nullopt;
  if (!failed_) return;
  out.count("not_written");
  out.log(LogLevel::error, "fleet_not_written", written.error().text());
}

}  // namespace trb::resilience
