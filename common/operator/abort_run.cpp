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
    known_ = view;
    const auto accepted = [self = shared_from_this()](const Message&) {
      self->end_ = self->session_.now().mono + self->wish_.wait;
      self->look();
    };
    send_signed<RunAbort>(session_, kSignedRunAbort, encode(order), on_success<Message>(done_, accepted));
  }

  /// What cannot be read now is no error: the order was accepted.
  void look() {
    if (known_.state == RunState::aborted || session_.now().mono >= end_) return done_(known_);
    const auto seen = [self = shared_from_this()](const Result<RunView>& view) { self->again(view); };
    session_.ask_node<RunView>(RunQuery{run_}, Callback<RunView>(seen));
  }

  void again(const Result<RunView>& view) {
    if (view) known_ = *view;
    if (known_.state == RunState::aborted) return done_(known_);
    session_.after(kLookForEnd, [self = shared_from_this()] { self->look(); });
  }

  Session& session_;
  const AbortWish wish_;
  const Callback<RunView> done_;
  std::string run_;
  RunView known_;  ///< read last
  MonotonicTime end_;
};

}  // namespace

void abort_run(Session& session, AbortWish wish, Callback<RunView> done) {
  std::make_shared<Abort>(session, std::move(wish), std::move(done))->start();
}

}  // namespace trb::op
