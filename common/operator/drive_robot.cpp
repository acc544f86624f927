#include "common/operator/drive_robot.hpp"

#include <cstring>
#include <memory>

#include "common/operator/nack_error.hpp"

namespace trb::op {
namespace {

/// What is older than this must not move a robot.
constexpr std::uint32_t kFresh_ms = 500;
constexpr Duration kDriveAnswer = std::chrono::milliseconds(500);
constexpr Duration kDriveEnd = std::chrono::seconds(2);

std::uint64_t number_from(const Bytes& bytes) {
  std::uint64_t number = 0;
  std::memcpy(&number, bytes.data(), std::min(sizeof number, bytes.size()));
  return number;
}

class HandDrive : public std::enable_shared_from_this<HandDrive> {
 public:
  HandDrive(Session& session, const DriveWish& wish, Callback<DriveReport> done)
      : session_(session), robot_(wish.robot), done_(std::move(done)), end_(session.now().mono + wish.lasts) {
    velocity_.part = wish.part;
    velocity_.speeds = wish.speeds;
    velocity_.drive = number_from(session.random_bytes(sizeof velocity_.drive));
    velocity_.take = wish.take;
    velocity_.by = wish.by;
  }

  void go_on() {
    if (over_) return;
    const bool last = session_.now().mono >= end_;
    ++velocity_.sequence;
    velocity_.over = last;
    const auto sent_at = session_.now().mono;
    const Send send{.type = MessageType::command, .target = robot_, .remaining_ms = kFresh_ms, .body = velocity_};
    const Status sent = session_.send(send, last ? kDriveEnd : kDriveAnswer,
                                      [self = shared_from_this(), sent_at, last](const Message* answer) {
                                        self->take_answer(answer, sent_at, last);
                                      });
    velocity_.take = false;  // one takeover is enough: who takes it back keeps it
    if (!sent) {
      over_ = true;
      return session_.after(Duration::zero(), [done = done_, error = sent.error()] { done(error); });
    }
    ++report_.sent;
    if (!last) session_.after(kDrivePeriod, [self = shared_from_this()] { self->go_on(); });
  }

 private:
  void take_answer(const Message* answer, MonotonicTime sent_at, bool last) {
    if (over_) return;
    if (answer != nullptr && answer->subtype == Nack::kSubtype) {
      const auto nack = decode<Nack>(answer->data);
      return end(nack ? nack_error(*nack) : nack.error());
    }
    if (answer != nullptr) report_.round_trips.push_back(to_seconds(session_.now().mono - sent_at) * 1000);
    if (!last) return;
    if (answer != nullptr) return end(std::move(report_));
    end(fail(Errc::timeout, "'" + robot_ + "' has not confirmed that it was let go",
             "its own node lets it stand after 250 ms; trb stop " + robot_));
  }

  void end(Result<DriveReport> result) {
    over_ = true;
    done_(std::move(result));
  }

  Session& session_;
  std::string robot_;
  Callback<DriveReport> done_;
  MonotonicTime end_;
  Velocity velocity_;
  DriveReport report_;
  bool over_ = false;
};

}  // namespace

void drive_robot(Session& session, const DriveWish& wish, const Callback<DriveReport>& done) {
  std::make_shared<HandDrive>(session, wish, done)->go_on();
}

}  // namespace trb::op
