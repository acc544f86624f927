#include "services/scheduler/core/named_run.hpp"

namespace trb::scheduler {
namespace {

const std::string& run_in(const TaskResult& result) {
  return result.key.run;
}

template <class Inside>
const std::string& run_in(const Inside& body) {
  return body.run;
}

template <class Inside>
Result<std::string> run_inside(const SignedRecord& record) {
  const auto body = decode<Inside>(record.payload.bytes);
  if (!body) return body.error();
  return run_in(*body);
}

template <class Inside>
std::string run_or_none(const SignedRecord& record) {
  const auto run = run_inside<Inside>(record);
  return run ? *run : std::string();
}

}  // namespace

std::string named_run(const Body& body) {
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

Result<std::string> run_of(const JournalRecord& record) {
  using Id = Result<std::string>;
  return std::visit(
      Overloaded{
          [](const JournalRun& is) { return run_inside<RunStart>(is.start); },
          [](const JournalStart& is) { return Id(is.key.run); },
          [](const JournalResult& is) { return run_inside<TaskResult>(is.result); },
          [](const JournalChoice& is) { return run_inside<Choice>(is.choice); },
          [](const JournalDelivered& is) { return Id(is.run); },
          [](const JournalAbort& is) { return run_inside<AbortOrder>(is.order); },
          [](const JournalDecision& is) { return run_inside<Decision>(is.decision); },
          [](const JournalPause& is) { return run_inside<PauseOrder>(is.order); },
          [](const JournalEnd& is) { return run_inside<RunEnd>(is.end); },
          [](const JournalArchive& is) { return Id(is.view.run); },
          [](const JournalTime&) { return Id(std::string()); },
          [](const JournalLost&) { return Id(std::string()); },
          [](const JournalTombstone& is) {
            return Id(fail(Errc::bad_value, "'" + std::string(is.kKind) + "' is no journal record any more"));
          },
      },
      record);
}

}  // namespace trb::scheduler
