#include "services/scheduler/core/refusal.hpp"

#include "services/scheduler/core/journal_records.hpp"

namespace trb::scheduler {
namespace {

template <class Inside>
std::string run_or_none(const SignedRecord& record) {
  const auto run = run_inside<Inside>(record);
  return run ? *run : std::string();
}

/// The run that a message is about, also inside a signed order or decision; empty: none.
std::string run_of_message(const Body& body) {
  return visit(Overloaded{[](const RunSubmit& one) { return run_or_none<RunStart>(one.start); },
                          [](const RunAbort& one) { return run_or_none<AbortOrder>(one.order); },
                          [](const RunPause& one) { return run_or_none<PauseOrder>(one.order); },
                          [](const RunDecision& one) { return run_or_none<Decision>(one.decision); },
                          [](const RunOver& one) { return run_or_none<RunEnd>(one.end); },
                          [](const auto& one) {
                            if constexpr (requires { std::string(one.run); }) return std::string(one.run);
                            return std::string();
                          }},
               body);
}

}  // namespace

void refuse(const Inbound& from, const Error& error, Step step) {
  // A counter for every subtype that a peer makes up would be a leak.
  const std::string subtype(holds_alternative<Opaque>(from.body) ? "opaque" : subtype_of(from.body));
  step.out.count("refused." + subtype + "." + std::string(errc_name(error.code)));
  step.out.nack(from, error, run_of_message(from.body));
}

void log_wrong_signature(const Error& error, Step step) {
  step.out.log(LogLevel::error, "own_signature_wrong", error.text());
}

void withhold_unsigned(Run& run, Step step) {
  if (!run.work().withheld().withhold_all()) return;
  step.out.log(LogLevel::error, "own_keys_changed",
               "run " + run.id() + " was made before this node got new keys: nobody would believe its results there, " +
                   "so it does no more of it; abort the run on another node (trb scenario abort), and start it anew");
}

Error not_own(const Inbound& from) {
  return fail(Errc::not_permitted, "'" + from.source + "' is another node: only the own one says that");
}

}  // namespace trb::scheduler
