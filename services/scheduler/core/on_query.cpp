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

constexpr std::size_t kMaxNamed = 8;
constexpr std::uint32_t kMaxPage = 500;

Result<std::string> newest(const std::vector<Run*>& runs, const Archive& archive) {
  const ArchivePage page = archive.page("", 1);
  if (runs.empty() && page.runs.empty()) return fail(Errc::unknown_run, "no run is known here", "trb scenario run");
  const bool is_open = page.runs.empty() || (!runs.empty() && runs.front()->start().created >= page.runs[0].created);
  return is_open ? runs.front()->id() : page.runs[0].run;
}

/// By a beginning of its id that no other has; the newest of all if nothing is named.
Result<std::string> choose(const std::vector<Run*>& runs, const Archive& archive, const std::string& beginning) {
  if (beginning.empty()) return newest(runs, archive);
  std::vector<std::string> matches;
  for (const Run* run : runs) {
    if (run->id().starts_with(beginning)) matches.push_back(run->id());
  }
  for (std::string& id : archive.ids(beginning, kMaxNamed + 1)) matches.push_back(std::move(id));
  if (matches.empty()) return fail(Errc::unknown_run, "no run begins with '" + beginning + "' here", "trb run list");
  if (matches.size() == 1) return matches.front();
  std::string names;
  for (std::size_t i = 0; i < matches.size() && i < kMaxNamed; ++i) names += (i == 0 ? "" : ", ") + matches[i];
  if (matches.size() > kMaxNamed) names += ", …";
  return fail(Errc::bad_value, "'" + beginning + "' is the beginning of several runs: " + names, "give more of the id");
}

}  // namespace

void SchedulerCore::handle(const RunQuery& body, const Inbound& from, Step step) {
  // A whole id, as programs ask by, is looked for in nothing but its place.
  const bool is_whole = runs_.find(body.run) != nullptr || archive_.over(body.run);
  const auto id = is_whole ? Result<std::string>(body.run) : choose(newest_first(runs_.runs()), archive_, body.run);
  if (!id) return refuse(from, id.error(), step);
  if (const Run* run = runs_.find(*id)) return step.out.reply(from, view_of(*run, executor_, step.clock()));
  if (auto view = archive_.view(*id)) return step.out.reply(from, std::move(*view));
  const auto over = archive_.over(*id);
  refuse(from,
         fail(Errc::expired, "run " + *id + " is over" + (over ? ": " + std::string(name_of(over->state)) : "") +
                                 "; its record has made room for younger ones"),
         step);
}

RunTable SchedulerCore::open_runs(Step step) const {
  RunTable table;
  for (const Run* run : newest_first(runs_.runs())) table.runs.push_back(summary_of(*run, executor_, step.clock()));
  table.open = static_cast<std::uint32_t>(table.runs.size());
  table.open_max = static_cast<std::uint32_t>(RunStore::kMaxRuns);
  return table;
}

void SchedulerCore::handle(const RunListRequest& body, const Inbound& from, Step step) {
  if (!body.all) return step.out.reply(from, open_runs(step));
  if (body.most == 0 || body.most > kMaxPage) {
    return refuse(from, fail(Errc::bad_value, "most: " + std::to_string(body.most), "ask for 1 to 500"), step);
  }
  ArchivePage page = archive_.page(body.after, body.most);
  RunTable table;
  table.runs = std::move(page.runs);
  table.more = page.more;
  table.open = static_cast<std::uint32_t>(runs_.runs().size());
  table.open_max = static_cast<std::uint32_t>(RunStore::kMaxRuns);
  step.out.reply(from, std::move(table));
}

void SchedulerCore::handle(const RunWatch& body, const Inbound& from, Step step) {
  if (auto added = watchers_.add(from, body.lease_s, step.now); !added) return refuse(from, added.error(), step);
  for (const Run* run : runs_.runs()) watchers_.told(from, run->id(), run->version());
  step.out.reply(from, open_runs(step));
}

void SchedulerCore::tell_watchers(Step step) {
  if (watchers_.empty()) return;
  watchers_.forget(step.now.mono);
  for (const Run* run : runs_.runs()) {
    watchers_.tell(
        run->id(), run->version(), [&] { return summary_of(*run, executor_, step.clock()); }, step.out);
  }
}

}  // namespace trb
