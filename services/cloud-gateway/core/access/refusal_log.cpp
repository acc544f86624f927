#include "services/cloud-gateway/core/access/refusal_log.hpp"

namespace trb::gateway {
namespace {

constexpr const char* kSelf = "gateway";
constexpr const char* kOthers = "other addresses";

/// Texts may have any character but this one.
std::string kind_of(const AuditRecord& refusal) {
  return refusal.who + '\0' + refusal.action + '\0' + refusal.about + '\0' + refusal.outcome;
}

}  // namespace

RefusalLog::Source& RefusalLog::source_of(const std::string& address) {
  const auto known = sources_.find(address);
  if (known != sources_.end()) return known->second;
  return sources_[sources_.size() < kSources ? address : std::string()];
}

bool RefusalLog::is_recorded(const AuditRecord& refusal, Now now) {
  if (sources_.empty()) began_ = now.mono;
  Source& source = source_of(refusal.from);
  const bool has_room = source.recorded.size() < kOfSource && recorded_ < kInAll;
  if (has_room && source.recorded.insert(kind_of(refusal)).second) {
    ++recorded_;
    return true;
  }
  ++source.more;
  return false;
}

std::vector<AuditRecord> RefusalLog::take_ended(Now now) {
  return now.mono - began_ < kWindow ? std::vector<AuditRecord>() : take_all(now);
}

std::vector<AuditRecord> RefusalLog::take_all(Now now) {
  std::vector<AuditRecord> out;
  for (const auto& [address, source] : sources_) {
    if (source.more == 0) continue;
    AuditRecord& record = out.emplace_back();
    record.time = now.utc.ns;
    record.who = kSelf;
    record.from = address.empty() ? kOthers : address;
    record.action = "refusals";
    record.outcome = std::to_string(source.more) + " more within a minute";
  }
  sources_.clear();
  recorded_ = 0;
  return out;
}

}  // namespace trb::gateway
