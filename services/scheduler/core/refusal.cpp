#include "services/scheduler/core/refusal.hpp"

#include "services/scheduler/core/named_run.hpp"

namespace trb::scheduler {

void refuse(const Inbound& from, const Error& error, Step step) {
  // A counter for every subtype that a peer makes up would be a leak.
  const std::string subtype(holds_alternative<Opaque>(from.body) ? "opaque" : subtype_of(from.body));
  step.out.count("refused." + subtype + "." + std::string(errc_name(error.code)));
  step.out.nack(from, error, named_run(from.body));
}

void log_wrong_signature(const Error& error, Step step) {
  step.out.log(LogLevel::error, "own_signature_wrong", error.text());
}

Error not_own(const Inbound& from) {
  return fail(Errc::not_permitted, "'" + from.source + "' is another node: only the own one says that");
}

}  // namespace trb::scheduler
