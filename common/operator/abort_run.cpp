#include "common/operator/abort_run.hpp"

#include <memory>

#include "common/operator/send_signed.hpp"

namespace trb::op {
namespace {

constexpr Duration kLookForEnd = std::chrono::milliseconds(100);

class Abort : public std::enable_shared_from_this<Abort> {
 public:
  Abort(Session& session, AbortWish wish, Callback<RunView> done)
      : session_(session), wish_(std::move(wish)), done_(std::move(done)) {}

  void start() {
    const auto order = [self = shared_from_this()](const RunView& view) { self->order(view); };
    session_.ask_node<RunView>(RunQuery{wish_.run}, on_success<RunView>(done_, order));
  }

 private:
  void order(const RunView& view) {
    run_ = view.run;
    const AbortOrder order{run_, session_.node(), wish_.reason, session_.now().utc.ns};
    const auto accepted = [self = shared_from_this(), view](const Message&) {
      self->end_ = self->session_.now().mono + self->wish_.wait;
      self->look(view);
    };
    send_signed<RunAbort>(session_, kSignedRunAbort, encode(order), on_success<Message>(done_, accepted));
  }

  void look(const Result<RunView>& last) {
    const bool over = last && last->state == RunState::aborted;
    if (over || session_.now().mono >= end_) return done_(last);
    const auto seen = [self = shared_from_this()](const Result<RunView>& view) { self->again(view); };
    session_.ask_node<RunView>(RunQuery{run_}, Callback<RunView>(seen));
  }

  void again(const Result<RunView>& view) {
    if (view && view->state == RunState::aborted) return done_(view);
    session_.after(kLookForEnd, [self = shared_from_this(), view] { self->look(view); });
  }

  Session& session_;
  const AbortWish wish_;
  const Callback<RunView> done_;
  std::string run_;
  MonotonicTime end_;
};

}  // namespace

void abort_run(Session& session, AbortWish wish, Callback<RunView> done) {
  std::make_shared<Abort>(session, std::move(wish), std::move(done))->start();
}

}  // namespace trb::op
