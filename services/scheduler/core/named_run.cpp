#include "services/scheduler/core/named_run.hpp"

namespace trb::scheduler {
namespace {

template <class Inside>
std::string run_inside(const SignedRecord& record) {
  const auto body = decode<Inside>(record.payload.bytes);
  return body ? body->run : "";
}

}  // namespace

std::string named_run(const Body& body) {
  return visit(Overloaded{[](const RunSubmit& one) { return run_inside<RunStart>(one.start); },
                          [](const RunAbort& one) { return run_inside<AbortOrder>(one.order); },
                          [](const RunPause& one) { return run_inside<PauseOrder>(one.order); },
                          [](const RunDecision& one) { return run_inside<Decision>(one.decision); },
                          [](const RunOver& one) { return run_inside<RunEnd>(one.end); },
                          [](const auto& one) {
                            if constexpr (requires { std::string(one.run); }) return std::string(one.run);
                            return std::string();
                          }},
               body);
}

}  // namespace trb::scheduler
