#include "services/scheduler/core/handlers/query_handler.hpp"

#include <ranges>

#include "services/scheduler/core/refusal.hpp"
#include "services/scheduler/core/signed_records.hpp"
#include "services/scheduler/core/view.hpp"

namespace trb::scheduler {
namespace {

constexpr std::size_t kMaxNamed = 8;
constexpr std::uint32_t kMaxPage = 500;
constexpr std::size_t kMaxAborted = 128;  ///< the newest of them: with every run that is open they fit into a message

auto newest_first(std::span<const Run* const> runs) {
  return std::views::reverse(runs);
}

Error ambiguous(const std::string& beginning, const std::vector<std::string>& matches) {
  std::string names;
  for (std::size_t i = 0; i < matches.size() && i < kMaxNamed; ++i) names += (i == 0 ? "" : ", ") + matches[i];
  if (matches.size() > kMaxNamed) names += ", …";
  return fail(Errc::bad_value, "'" + beginning + "' is the beginning of several runs: " + names, "give more of the id");
}

}  // namespace

Result<std::string> QueryHandler::newest() const {
  const ArchivePage page = archive_.page("", 1);
  const std::span<const Run* const> open = runs_.runs();
  if (open.empty() && page.runs.empty()) return fail(Errc::unknown_run, "no run is known here", "trb scenario run");
  const bool is_open =
      page.runs.empty() || (!open.empty() && open.back()->definition().start().created >= page.runs[0].created);
  return is_open ? open.back()->id() : page.runs[0].run;
}

Result<std::string> QueryHandler::choose(const std::string& beginning) const {
  if (beginning.empty()) return newest();
  std::vector<std::string> matches;
  for (const Run* run : newest_first(runs_.runs())) {
    if (run->id().starts_with(beginning)) matches.push_back(run->id());
  }
  for (std::string& id : archive_.ids(beginning, kMaxNamed + 1)) matches.push_back(std::move(id));
  if (matches.empty()) return fail(Errc::unknown_run, "no run begins with '" + beginning + "' here", "trb run list");
  if (matches.size() > 1) return ambiguous(beginning, matches);
  return matches.front();
}

Result<std::string> QueryHandler::find(const std::string& name) const {
  // A complete id, as programs send it, is found directly.
  const bool is_whole = runs_.find(name) != nullptr || archive_.over(name);
  return is_whole ? Result<std::string>(name) : choose(name);
}

Error QueryHandler::gone(const std::string& run, const Error& why) const {
  if (why.code != Errc::missing) return why;
  const auto over = archive_.over(run);
  return fail(Errc::expired, "run " + run + " is over" + (over ? ": " + std::string(name_of(over->state)) : "") +
                                 "; its record has made room for younger ones");
}

void QueryHandler::handle(const RunQuery& body, const Inbound& from, Step step) {
  const auto id = find(body.run);
  if (!id) return refuse(from, id.error(), step);
  if (const Run* run = runs_.find(*id)) return step.out.reply(from, view_of(*run, runs_, executor_, step.clock()));
  auto record = archive_.record(*id);
  if (!record) return refuse(from, gone(*id, record.error()), step);
  step.out.reply(from, std::move(record->view));
}

void QueryHandler::handle(const RunProofRequest& body, const Inbound& from, Step step) {
  const auto id = find(body.run);
  if (!id) return refuse(from, id.error(), step);
  Result<JournalArchive> fact = JournalArchive();
  if (const Run* run = runs_.find(*id)) {
    put_signed_records(*run, *fact);
  } else if (fact = archive_.record(*id); !fact) {
    return refuse(from, gone(*id, fact.error()), step);
  }
  const std::vector<SignedRecord> all = signed_records_of(*fact);
  if (all.empty()) {
    return refuse(from, fail(Errc::missing, "an earlier version has archived run " + *id + " without its start"), step);
  }
  RunRecords page = page_of(all, body.first);
  page.run = *id;
  step.out.reply(from, std::move(page));
}

RunTable QueryHandler::open_runs(Step step) const {
  RunTable table;
  std::size_t aborted = 0;
  for (const Run* run : newest_first(runs_.runs())) {
    if (run->orders().is_aborted() && ++aborted > kMaxAborted) continue;
    table.runs.push_back(summary_of(*run, runs_, executor_, step.clock()));
  }
  table.open = static_cast<std::uint32_t>(runs_.taken());
  table.open_max = static_cast<std::uint32_t>(RunStore::kMaxRuns);
  return table;
}

void QueryHandler::handle(const RunListRequest& body, const Inbound& from, Step step) {
  if (!body.all) return step.out.reply(from, open_runs(step));
  if (body.most == 0 || body.most > kMaxPage) {
    return refuse(from, fail(Errc::bad_value, "most: " + std::to_string(body.most), "ask for 1 to 500"), step);
  }
  ArchivePage page = archive_.page(body.after, body.most);
  RunTable table;
  table.runs = std::move(page.runs);
  table.more = page.more;
  table.open = static_cast<std::uint32_t>(runs_.taken());
  table.open_max = static_cast<std::uint32_t>(RunStore::kMaxRuns);
  step.out.reply(from, std::move(table));
}

void QueryHandler::handle(const RunWatch& body, const Inbound& from, Step step) {
  if (auto added = watchers_.add(from, body.lease_s, step.now); !added) return refuse(from, added.error(), step);
  for (const Run* run : runs_.runs()) watchers_.note_sent(from, run->id(), run->version());
  step.out.reply(from, open_runs(step));
}

void QueryHandler::notify_watchers(Step step) {
  if (watchers_.empty()) return;
  watchers_.forget(step.now.mono);
  for (const Run* run : runs_.runs()) {
    const auto summary = [&] { return summary_of(*run, runs_, executor_, step.clock()); };
    watchers_.notify(run->id(), run->version(), summary, step.out);
  }
}

}  // namespace trb::scheduler
