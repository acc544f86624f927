#include "common/operator/follow_run.hpp"

#include <memory>

namespace trb::op {
namespace {

constexpr Duration kLookAtRun = std::chrono::milliseconds(150);

class Follow : public std::enable_shared_from_this<Follow> {
 public:
  using Seen = std::function<bool(const RunView&, const RunView&)>;
  Follow(Session& session, FollowWish wish, Seen seen, Callback<RunView> done)
      : session_(session),
        wish_(std::move(wish)),
        seen_(std::move(seen)),
        done_(std::move(done)),
        end_(session.now().mono + wish_.wait) {}

  void look() {
    const auto take = [self = shared_from_this()](Result<RunView> view) { self->take(std::move(view)); };
    session_.ask_node<RunView>(RunQuery{wish_.run}, Callback<RunView>(take));
  }

 private:
  void take(Result<RunView> view) {
    const bool late = session_.now().mono >= end_;
    if (!view && (!followed_ || late || is_final(view.error().code))) return done_(view.error());
    if (view) {
      const bool goes_on = seen_(last_, *view);
      last_ = std::move(*view);
      followed_ = true;
      wish_.run = last_.run;  // not a newer one from now on, nor one more with the same beginning
      if (!goes_on || late || ends()) return done_(std::move(last_));
    }
    session_.after(kLookAtRun, [self = shared_from_this()] { self->look(); });
  }

  /// The scheduler's own word, which the next look would have again.
  static bool is_final(Errc code) {
    return code == Errc::unknown_run || code == Errc::expired || code == Errc::bad_value;
  }

  [[nodiscard]] bool ends() const {
    const bool stuck = wish_.until_paused && last_.state == RunState::paused;
    return is_over(last_.state) || stuck || wish_.once;
  }

  Session& session_;
  FollowWish wish_;
  const Seen seen_;
  const Callback<RunView> done_;
  const MonotonicTime end_;
  RunView last_;
  bool followed_ = false;
};

}  // namespace

bool is_over(RunState state) {
  return state == RunState::finished || state == RunState::aborted || state == RunState::expired;
}

void follow_run(Session& session, FollowWish wish, std::function<bool(const RunView&, const RunView&)> seen,
                Callback<RunView> done) {
  std::make_shared<Follow>(session, std::move(wish), std::move(seen), std::move(done))->look();
}

}  // namespace trb::op
