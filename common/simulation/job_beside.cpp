#include "common/simulation/job_beside.hpp"

#include "common/simulation/job_times.hpp"

namespace trb::simulation {

std::vector<JobRun> read_beside(ObjectReader& reader) {
  std::vector<JobRun> out;
  const Value::List* runs = reader.list("beside", Need::optional, kMostBeside);
  for (std::size_t i = 0; runs != nullptr && i < runs->size(); ++i) {
    ObjectReader one((*runs)[i], "beside[" + std::to_string(i) + "]", reader.faults());
    JobRun run{.scenario = one.value("scenario", Need::required), .after_s = 0, .path = one.path("scenario")};
    run.after_s = one.number("after", Need::optional, {0, kMaxUntil}).value_or(0);
    one.refuse_unknown_keys();
    if (run.scenario != nullptr) out.push_back(std::move(run));
  }
  return out;
}

}  // namespace trb::simulation
