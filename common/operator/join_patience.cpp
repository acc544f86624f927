#include "common/operator/join_patience.hpp"

#include <utility>

namespace trb::op {
namespace {

using Kind = DoorAnswer::Kind;

bool is_unknown(const DoorAnswer& answer) {
  return answer.kind == Kind::refused ||
         (answer.kind == Kind::goodbye && answer.text == errc_name(Errc::unknown_peer_key));
}

bool calls_too_often(const DoorAnswer& answer) {
  return answer.kind == Kind::goodbye && answer.text == errc_name(Errc::queue_full);
}

}  // namespace

Status JoinPatience::on_offer(JoinStage stage, MonotonicTime now) {
  good_ = now;
  unknown_.reset();
  if (std::exchange(stage_, stage) != stage) since_ = now;
  if (stage == JoinStage::joined || now - since_ < kUnsigned) return Done{};
  return fail(Errc::timeout, "the cloud node at " + address_ + " answers, the inviter does not",
              "is trb fleet invite still open there? then join again with the same code");
}

Status JoinPatience::on_none(const DoorAnswer& answer, JoinStage stage, MonotonicTime now) {
  if (answer.text.starts_with(errc_name(Errc::version_mismatch)))
    return fail(Errc::version_mismatch, "the cloud node at " + address_ + " has another version",
                "install the same version on both");
  if (stage == JoinStage::asks && is_unknown(answer)) return on_unknown(now);
  unknown_.reset();
  if (stage == JoinStage::asks && answer.kind == Kind::goodbye && !calls_too_often(answer))
    return fail(Errc::not_permitted, "the cloud node at " + address_ + " does not take the call: " + answer.text,
                "look into its log: trb logs there");
  return now - good_ < patience(stage) ? Status(Done{}) : Status(given_up(answer));
}

Status JoinPatience::on_unknown(MonotonicTime now) {
  if (!unknown_) unknown_ = now;
  if (now - *unknown_ < kUnknown) return Done{};
  return fail(Errc::not_permitted,
              "the cloud node at " + address_ +
                  " does not know this code: it was used or has ended, or its trb fleet invite has",
              "is trb fleet invite still open there? then join again with the same code, else ask for a new one");
}

Error JoinPatience::given_up(const DoorAnswer& answer) const {
  if (answer.kind == Kind::nobody) {
    return fail(
        Errc::peer_unreachable,
        "nobody at " + address_ + " has the cloud node's key: it is not reached from here, or another computer answers",
        "ping it; if another address leads to it: --at HOST:PORT; if somebody stands between, join from "
        "another network");
  }
  if (calls_too_often(answer)) {
    return fail(Errc::queue_full, "the cloud node at " + address_ + " is called too often with this code",
                "end the other trb node join that uses it; if there is none of yours, ask for a new code");
  }
  return fail(Errc::timeout, "the cloud node at " + address_ + " gives no good answer any more",
              "join again; if the code is over, with a new one");
}

Duration JoinPatience::patience(JoinStage stage) const {
  if (stage == JoinStage::asks) return nobody_;
  return stage == JoinStage::invited ? kForgotten : kUnconfirmed;
}

Duration JoinPatience::pause() const {
  return unknown_ ? std::chrono::milliseconds(1000) : std::chrono::milliseconds(350);
}

}  // namespace trb::op
