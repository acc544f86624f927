// SchedulerCore: what watchers ask.
#include <algorithm>

#include "services/scheduler/core/scheduler_core.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb {

using namespace scheduler;

namespace {

/// Newest first.
std::vector<Run*> newest_first(std::vector<Run*> runs) {
  std::reverse(runs.begin(), runs.end());
  return runs;
}

Result<const Run*> choose(const std::vector<Run*>& runs, const std::string& beginning) {
  std::vector<const Run*> matches;
  for (const Run* run : runs) {
    if (run->id().starts_with(beginning)) matches.push_back(run);
  }
  if (matches.empty()) return fail(Errc::unknown_run, "no run begins with '" + beginning + "' here");
  if (matches.size() == 1 || beginning.empty()) return matches.front();
  std::string names;
  for (std::size_t i = 0; i < matches.size() && i < 8; ++i) names += (i == 0 ? "" : ", ") + matches[i]->id();
  if (matches.size() > 8) names += ", …";
  return fail(Errc::bad_value, "'" + beginning + "' is the beginning of several runs: " + names, "give more of the id");
}

}  // namespace

void SchedulerCore::handle(const RunQuery& body, const Inbound& from, Step step) {
  if (book_.is_over(body.run)) return refuse(from, fail(Errc::expired, "run " + body.run + " is over"), step);
  const auto run = choose(newest_first(book_.runs()), body.run);
  if (!run) return refuse(from, run.error(), step);
  step.out.reply(from, view_of(**run, executor_, step.now.utc));
}

void SchedulerCore::handle(const RunListRequest&, const Inbound& from, Step step) {
  RunTable table;
  for (const Run* run : newest_first(book_.runs())) table.runs.push_back(summary_of(*run, executor_, step.now.utc));
  step.out.reply(from, std::move(table));
}

void SchedulerCore::handle(const RunWatch& body, const Inbound& from, Step step) {
  if (auto added = watchers_.add(from, body.lease_s, step.now); !added) return refuse(from, added.error(), step);
  RunTable table;
  for (const Run* run : newest_first(book_.runs())) {
    table.runs.push_back(summary_of(*run, executor_, step.now.utc));
    watchers_.told(from, run->id(), run->version());
  }
  step.out.reply(from, std::move(table));
}

void SchedulerCore::tell_watchers(Step step) {
  if (watchers_.empty()) return;
  watchers_.forget(step.now.mono);
  for (const Run* run : book_.runs()) {
    watchers_.tell(
        run->id(), run->version(), [&] { return summary_of(*run, executor_, step.now.utc); }, step.out);
  }
}

}  // namespace trb
