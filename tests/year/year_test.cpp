// What a hall relies on: 100,000 runs a month, and everything that goes wrong meanwhile.
//   TRB_DAYS=N how many days (1; scripts/test-year plays 30, or 365)   TRB_SEED=N another year (1)
#include <doctest/doctest.h>
#include <sys/resource.h>

#include <chrono>
#include <cstdio>

#include "tests/year/hall.hpp"

using namespace trb;
using namespace trb::year;

namespace {

constexpr std::uint64_t kTold = 10;  ///< days

long most_memory_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return usage.ru_maxrss / 1024;
}

void tell_progress(std::uint64_t day, const Figures& is) {
  std::printf("day %llu: %llu runs, lost %llu, twice %llu, without a name %llu; %zu records in a journal, %ld MB\n",
              static_cast<unsigned long long>(day), static_cast<unsigned long long>(is.runs),
              static_cast<unsigned long long>(is.lost), static_cast<unsigned long long>(is.twice),
              static_cast<unsigned long long>(is.nameless), is.most_journal, most_memory_mb());
  std::fflush(stdout);
}

}  // namespace

TEST_CASE("20 robots do 100,000 runs a month: nothing is lost, nothing done twice, nothing waits without a name") {
  const std::uint64_t days = scheduler::test::from_environment("TRB_DAYS", 1);
  Hall hall(scheduler::test::from_environment("TRB_SEED", 1));
  const auto begun = std::chrono::steady_clock::now();
  std::size_t journal_of_first_half = 0;
  for (std::uint64_t day = 0; day < days; ++day) {
    hall.day();
    if ((day + 1) % kTold == 0) tell_progress(day + 1, hall.figures);
    if (day == days / 2) journal_of_first_half = hall.figures.most_journal;
  }
  hall.finish();
  const double took_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  const Figures& is = hall.figures;
  MESSAGE(days << " days: " << is.runs << " runs, " << is.tasks << " tasks, " << is.failures << " failures, "
               << is.faults << " faults, " << is.restarts << " restarts, " << is.cuts << " cuts");
  MESSAGE(is.finished << " FINISHED, " << is.aborted << " ABORTED, " << is.expired << " EXPIRED; " << is.decisions
                      << " decisions, " << is.words << " by a person's word");
  MESSAGE("at most " << is.most_open << " runs open, " << is.most_journal << " records in a journal, " << is.most_alerts
                     << " alerts kept; " << most_memory_mb() << " MB, " << took_s << " s");
  for (const std::string& row : hall.errors) MESSAGE(row);
  CHECK(is.lost == 0);
  CHECK(is.twice == 0);
  CHECK(is.nameless == 0);
  CHECK(is.finished + is.aborted + is.expired == is.runs);
  CHECK(is.most_open < 512);
  CHECK(is.most_alerts < 456);
  // What is kept of runs that are over does not make the journal grow.
  if (days >= 10) CHECK(is.most_journal < 2 * journal_of_first_half);
}
