#include "services/router/io/proof_log.hpp"

#include <algorithm>
#include <utility>

#include "common/base/ids.hpp"

namespace trb::router {
namespace {

constexpr std::uint64_t kMaxPending = 4U << 20U;  ///< of one link between two seals

}  // namespace

ProofLog::ProofLog(const std::string& dir, std::uint64_t max_bytes)
    : max_pending_(static_cast<std::size_t>(std::min(kMaxPending, max_bytes / 4))) {
  if (max_bytes > 0) writer_ = std::make_unique<ProofWriter>(dir, max_bytes);
}

void ProofLog::add(const LinkSeals& link, UtcTime now, BytesView frame) {
  if (!on()) return;
  const auto [at, fresh] = open_.try_emplace(link.in.link);
  Open& open = at->second;
  if (fresh) {
    open.peer = link.signer && is_valid_id(link.signer->id) ? link.signer->id : "";  // it becomes part of a file's name
    open.link = std::make_shared<const ProofLink>(
        ProofLink{link.in.link, !link.in.dialled, 1, first_previous(), *link.own, link.peer});
  }
  ++open.frames;
  open.overflow = open.overflow || open.records.size() + frame.size() > max_pending_;
  if (!open.overflow) append_proof_frame(open.records, link.in.link, now, frame);
}

void ProofLog::sealed(const LinkSeals& link) {
  const auto at = open_.find(link.in.link);
  if (at == open_.end()) return;
  hand_over(at->second, false);
  at->second.first = link.reader.first();
  at->second.previous = link.reader.previous();
}

void ProofLog::ended(LinkId link, UtcTime now, std::string_view why) {
  const auto at = open_.find(link);
  if (at == open_.end()) return;
  append_proof_end(at->second.records, link, now, why);
  hand_over(at->second, true);
  open_.erase(at);
}

void ProofLog::hand_over(Open& open, bool last) {
  const std::size_t size = open.records.size();
  const std::uint64_t frames = std::exchange(open.frames, 0);
  ProofBatch batch{open.peer, open.link,   open.first, open.previous, std::exchange(open.records, {}),
                   frames,    open.retell, last};
  open.retell = std::exchange(open.overflow, false) || !writer_->put(std::move(batch));
  if (open.retell) dropped_ += frames;
  // The next range will need about as much.
  open.records.reserve(std::min<std::size_t>(size + size / 8, 64U << 10U));
}

}  // namespace trb::router
