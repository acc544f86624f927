#include "common/operator/run_records.hpp"

#include <memory>

namespace trb::op {
namespace {

constexpr int kMaxRestarts = 3;

class Reading : public std::enable_shared_from_this<Reading> {
 public:
  Reading(Session& session, std::string run, Callback<RunRecords> done)
      : session_(session), run_(std::move(run)), done_(std::move(done)) {}

  void ask() {
    const auto first = static_cast<std::uint32_t>(all_.records.size());
    const auto take = [self = shared_from_this()](RunRecords page) { self->take(std::move(page)); };
    session_.ask_node<RunRecords>(RunProofRequest{run_, first}, on_success<RunRecords>(done_, take));
  }

 private:
  void take(RunRecords page) {
    if (all_.records.empty()) {
      run_ = all_.run = page.run;  // a beginning may fit another run by the next page
      all_.count = page.count;
    }
    if (page.run != all_.run || page.count != all_.count) return restart();
    for (SignedRecord& record : page.records) {
      bytes_ += record.payload.bytes.size();
      all_.records.push_back(std::move(record));
    }
    if (bytes_ > kMostProofBytes) {
      return done_(
          fail(Errc::too_large,
               "run " + all_.run + ": what is signed of it has more than " + std::to_string(kMostProofBytes) + " bytes",
               "let its tasks give shorter results"));
    }
    if (all_.records.size() == all_.count) return done_(std::move(all_));
    // A scheduler that sends nothing must not be asked for ever.
    const bool wrong = page.records.empty() || all_.records.size() > all_.count || all_.count > kMaxRunRecords;
    if (wrong) return done_(fail(Errc::malformed, "run " + all_.run + ": the scheduler's pages do not fit its count"));
    ask();
  }

  /// Something was signed meanwhile.
  void restart() {
    if (++restarts_ > kMaxRestarts) {
      return done_(fail(Errc::conflict, "run " + run_ + " changes while it is read", "try again when it is quiet"));
    }
    all_ = {};
    bytes_ = 0;
    ask();
  }

  Session& session_;
  std::string run_;
  const Callback<RunRecords> done_;
  RunRecords all_;
  std::size_t bytes_ = 0;  ///< of its payloads
  int restarts_ = 0;
};

}  // namespace

void read_run_records(Session& session, const std::string& run, const Callback<RunRecords>& done) {
  std::make_shared<Reading>(session, run, done)->ask();
}

}  // namespace trb::op
