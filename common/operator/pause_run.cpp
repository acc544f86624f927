#include "common/operator/pause_run.hpp"

#include "common/operator/send_signed.hpp"

namespace trb::op {
namespace {

PauseOrder order_of(const RunView& view, bool paused, const std::string& node, const std::string& reason, UtcTime now) {
  PauseOrder order{view.run, view.pause_number + 1, paused, node, reason, now.ns, {}};
  // The person who lets it continue has seen which tasks were done twice.
  for (const TaskView& task : view.tasks) {
    if (!paused && task.twice) order.doubles.push_back(task.id);
  }
  return order;
}

/// The run as the accepted order leaves it: for who cannot read it now, and must not take the order for refused.
RunView as_ordered(RunView view, const PauseOrder& order) {
  view.pause_number = order.number;
  view.paused_by = order.paused ? order.by : "";
  if (view.state == RunState::running || view.state == RunState::paused)
    view.state = order.paused ? RunState::paused : RunState::running;
  return view;
}

void hold(Session& session, bool paused, const std::string& run, const std::string& reason,
          const Callback<RunView>& done) {
  const auto order = [&session, paused, reason, done](const RunView& view) {
    const PauseOrder pause = order_of(view, paused, session.node(), reason, session.now().utc);
    const auto look = [&session, known = as_ordered(view, pause), done](const Message&) {
      const auto seen = [known, done](const Result<RunView>& read) { done(read ? read : Result<RunView>(known)); };
      session.ask_node<RunView>(RunQuery{known.run}, Callback<RunView>(seen));
    };
    send_signed<RunPause>(session, kSignedRunPause, encode(pause), on_success<Message>(done, look));
  };
  session.ask_node<RunView>(RunQuery{run}, on_success<RunView>(done, order));
}

}  // namespace

void pause_run(Session& session, const std::string& run, const std::string& reason, const Callback<RunView>& done) {
  hold(session, true, run, reason, done);
}

void resume_run(Session& session, const std::string& run, const std::string& reason, const Callback<RunView>& done) {
  hold(session, false, run, reason, done);
}

}  // namespace trb::op
