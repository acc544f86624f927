#include "common/operator/list_runs.hpp"

#include <memory>
#include <set>

namespace trb::op {
namespace {

constexpr std::uint32_t kPage = 100;

/// Reads the archive page by page after the open runs.
class RunList : public std::enable_shared_from_this<RunList> {
 public:
  RunList(Session& session, Callback<RunTable> done) : session_(session), done_(std::move(done)) {}

  void begin(RunTable open) {
    table_ = std::move(open);
    for (const RunSummary& run : table_.runs) known_.insert(run.run);
    read_page();
  }

 private:
  void read_page() {
    if (table_.runs.size() >= kMostRunsListed) return finish();
    const auto take = [self = shared_from_this()](RunTable page) { self->take(std::move(page)); };
    session_.ask_node<RunTable>(RunListRequest{true, after_, kPage}, on_success<RunTable>(done_, take));
  }

  void take(RunTable page) {
    // A scheduler that sends the same page again must not be asked for ever.
    const bool more = page.more && !page.runs.empty() && page.runs.back().run != after_;
    if (!page.runs.empty()) after_ = page.runs.back().run;
    for (RunSummary& run : page.runs) {
      // A run may have ended meanwhile, and be in both lists.
      if (known_.insert(run.run).second) table_.runs.push_back(std::move(run));
    }
    more ? read_page() : finish();
  }

  void finish() {
    table_.more = table_.runs.size() >= kMostRunsListed;
    done_(std::move(table_));
  }

  Session& session_;
  const Callback<RunTable> done_;
  RunTable table_;
  std::set<std::string> known_;
  std::string after_;
};

}  // namespace

void list_runs(Session& session, bool all, const Callback<RunTable>& done) {
  if (!all) return session.ask_node<RunTable>(RunListRequest{}, done);
  const auto archive = std::make_shared<RunList>(session, done);
  const auto begin = [archive](RunTable open) { archive->begin(std::move(open)); };
  session.ask_node<RunTable>(RunListRequest{}, on_success<RunTable>(done, begin));
}

}  // namespace trb::op
