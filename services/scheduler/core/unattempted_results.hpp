// Results that need no attempt: SKIPPED, given back, what has yet to get a robot or got none in time, and what cannot
// be begun. This node has them signed.
#pragma once

#include <string>

#include "services/scheduler/core/run_journal.hpp"

namespace trb::scheduler {

class UnattemptedResults {
 public:
  /// The journal must outlive it.
  UnattemptedResults(std::string node, RunJournal& journal) : node_(std::move(node)), journal_(journal) {}

  /// At a step's end: has signed what follows from the facts by now, and gives up what does not any more.
  void request(Run& run, Step step) const;
  /// Keeps such a result once it is signed; false if it is another record.
  bool keep_signed(Run& run, const SignedRecord& record, Step step);

 private:
  std::string node_;
  RunJournal& journal_;
};

}  // namespace trb::scheduler
