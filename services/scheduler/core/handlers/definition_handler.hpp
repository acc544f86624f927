// How a run becomes known: it is submitted here, or its baton comes and its definition follows.
#pragma once

#include "common/actor/takes.hpp"
#include "services/scheduler/core/run/compact_start.hpp"
#include "services/scheduler/core/run_journal.hpp"
#include "services/scheduler/core/run_lookup.hpp"

namespace trb::scheduler {

class DefinitionHandler {
 public:
  using Taken = Takes<RunSubmit, NeedDefinition, Definition>;

  /// `dispatch` handles the messages that waited for a definition. All must outlive it.
  DefinitionHandler(std::string node, RunStore& runs, RunLookup& lookup, RunJournal& journal,
                    RunLookup::Dispatch dispatch)
      : node_(std::move(node)), runs_(runs), lookup_(lookup), journal_(journal), dispatch_(std::move(dispatch)) {}

  void handle(const RunSubmit& body, const Inbound& from, Step step);
  void handle(const NeedDefinition& body, const Inbound& from, Step step);
  void handle(const Definition& body, const Inbound& from, Step step);
  /// Of the own router. The definitions that waited for it are opened; whose certificates it lacks are requested whole.
  void on_routes(const RouteTable& table, Step step);

 private:
  [[nodiscard]] Status check_created(const Run& run, UtcTime steady) const;
  [[nodiscard]] Status check_new(const Run& run, Step step) const;
  [[nodiscard]] bool makes_member(const Run& run, const Definition& body) const;
  Status submit(std::unique_ptr<Run> run, Run* known, Step step);
  void handle_compact(const Inbound& from, Step step, bool may_wait);
  void wait_for_routes(const std::string& run, const Inbound& from, Step step);
  void take(const Definition& body, const RunStart& claimed, const Inbound& from, Step step);
  static void request_whole(const std::string& run, const Inbound& from, Step step);
  void handle_more(Run& run, const Definition& body, const Inbound& from, Step step);
  /// Each: false if one of them is not believed.
  bool keep_decisions(Run& run, const Definition& body, const Inbound& from, Step step);
  bool keep_orders(Run& run, const Definition& body, const Inbound& from, Step step);

  std::string node_;
  RunStore& runs_;
  RunLookup& lookup_;
  RunJournal& journal_;
  RunLookup::Dispatch dispatch_;
  KnownCertificates certificates_;
  std::optional<MonotonicTime> routes_asked_;  ///< the own router, which has not answered yet
  std::vector<Inbound> waiting_;               ///< compact definitions with a member whose certificate is not known yet
};

}  // namespace trb::scheduler
