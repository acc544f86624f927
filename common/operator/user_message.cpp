#include "common/operator/user_message.hpp"

#include "common/base/ids.hpp"
#include "common/operator/nack_error.hpp"

namespace trb::op {
namespace {

constexpr Duration kNackWait = std::chrono::milliseconds(300);

}  // namespace

Result<Body> user_body(const std::string& subtype, const std::string& data) {
  if (!is_valid_word(subtype))
    return fail(Errc::bad_value, "SUBTYPE: '" + subtype + "' is no word", "letters, digits, '_' and '-'");
  if (data.size() > kMaxDataSize) return fail(Errc::too_large, "DATA: over 1 MiB", "send it in parts");
  if (!is_reserved(subtype)) return Body{Opaque{subtype, data}};
  auto bytes = body_from_json(subtype, data.empty() ? "{}" : data);
  if (!bytes) {
    auto like = body_to_json(subtype, "\x90");  // an empty array: every field at its default
    return fail(bytes.error().code, "DATA of " + subtype + ": " + bytes.error().what,
                like ? "write it like " + *like : bytes.error().hint);
  }
  return decode_body(subtype, *bytes);
}

void send_information(Session& session, const Send& send, const Callback<Done>& done) {
  const auto answered = [done](const Message* answer) {
    const bool refused = answer != nullptr && answer->subtype == Nack::kSubtype;
    const auto nack = refused ? decode<Nack>(answer->data) : Result<Nack>(Error{});
    done(nack ? Status(nack_error(*nack)) : Status(Done{}));
  };
  const Status sent = session.send(send, kNackWait, answered);
  if (!sent) session.after(Duration::zero(), [done, sent] { done(sent); });
}

}  // namespace trb::op
