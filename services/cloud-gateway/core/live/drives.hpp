// Who drives which robot by hand: one person a robot, only the newest speeds, and an end for whoever falls silent.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "common/base/result.hpp"
#include "services/cloud-gateway/core/live/row_book.hpp"
#include "services/cloud-gateway/core/live/subscriptions.hpp"

namespace trb::gateway {

/// A client of the live stream, and for whom it acts.
struct Driver {
  ClientId client = 0;
  std::string name;  ///< "ann", "token:yard"
  std::string from;  ///< its address, for the audit log
};

struct DriveWord {
  std::string robot;
  DrivePart part{};
  std::vector<double> speeds;
  std::uint64_t sequence = 0;  ///< 1 begins a drive; a later one of a drive that is over starts nothing
  bool take = false;           ///< takes the robot from who has it; counts with sequence 1 only
};

/// A command to a robot's node.
struct DriveOrder {
  std::string robot;
  Velocity velocity;
};

/// What a client is told of its own words.
struct DriveAnswer {
  ClientId client = 0;
  std::string robot;
  std::uint64_t sequence = 0;
  bool is_over = false;          ///< the robot is not driven by this client (any more)
  double round_trip_s = 0;       ///< gateway - robot's node - gateway; 0: none
  std::optional<Error> error{};  ///< why it is over, or why it was refused
};

/// For the audit log: a drive that began, or was refused, was taken or ended.
struct DriveNote {
  std::string who;
  std::string from;
  std::string action;  ///< "drive begin", "drive take", "drive end"
  std::string about;   ///< "pioneer1 base"; of a drive that was taken: "pioneer1 base from ann"
  std::string outcome;
};

/// What follows from the words so far. Orders go out first.
struct DriveEffects {
  std::vector<DriveOrder> orders;
  std::vector<DriveNote> notes;
  std::vector<DriveAnswer> answers;
  [[nodiscard]] bool empty() const { return orders.empty() && notes.empty() && answers.empty(); }
};

/// A robot:
///
/// -       | word 1 of anybody                                   | driving: order
/// -       | another word                                        | -: told that it is over
/// driving | a newer word of its driver                          | driving: order, or kept as the newest until the
///         |                                                     |   one under way is answered
/// driving | an older or repeated word of its driver             | driving: refused
/// driving | word 1 of another                                   | driving: refused, naming the driver
/// driving | the same, with `take`                               | driving, by the other: `over`, order; both are told
/// driving | another asks                                        | driving: its row names who asks, for 30 s
/// driving | the driver lets go, leaves, or is silent for 500 ms | kept, if somebody asks; else -: `over`
/// driving | its node refuses, or does not answer for 500 ms     | the same; the driver is told why
/// kept    | word 1 of who asked                                 | driving: order
/// kept    | word 1 of another                                   | refused; with `take`: driving
/// kept    | 10 s, or who asked leaves                           | -
///
/// The end needs no answer: the robot's own node ends a drive 500 ms after its last word.
class Drives {
 public:
  static constexpr Duration kSilence = std::chrono::milliseconds(500);
  static constexpr Duration kAnswer = std::chrono::milliseconds(500);
  static constexpr Duration kAsked = std::chrono::seconds(30);
  static constexpr Duration kKept = std::chrono::seconds(10);
  static constexpr Duration kBeginAgain = std::chrono::milliseconds(250);
  static constexpr int kWordsPerSecond = 25;  ///< of one client, as many at once

  /// The book must outlive it.
  explicit Drives(RowBook& book) : book_(book) {}

  /// Errors: queue_full (too many words), unknown_target (no such robot). What else is refused is an answer.
  Status drive(const Driver& driver, DriveWord word, Now now);
  /// Of a robot that the client does not drive: nothing.
  void let_go(ClientId client, const std::string& robot, Now now);
  /// Errors: those of drive().
  Status ask(const Driver& driver, const std::string& robot, Now now);
  /// The client has gone, or may not drive any more.
  void leave(ClientId client, Now now);
  /// The node's answer to an order: true if the drive goes on, false if it is over.
  void answered(const DriveOrder& order, const Result<bool>& answer, Now now);
  void tick(Now now);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;
  DriveEffects take_effects() { return std::exchange(effects_, {}); }

 private:
  struct UnderWay {
    std::uint64_t sequence = 0;
    MonotonicTime since;
  };
  struct Drive {
    Driver driver;
    DrivePart part{};
    std::uint64_t number = 0;
    std::uint64_t sequence = 0;  ///< of the driver's last word
    MonotonicTime heard;         ///< when it came
    std::string taken_from;      ///< who had the robot
    bool has_begun = false;      ///< its node has agreed
    std::optional<UnderWay> under_way;
    std::optional<DriveWord> newest;  ///< waits for the answer
  };
  struct Asked {
    Driver driver;
    MonotonicTime until;
  };
  struct Robot {
    std::optional<Drive> drive;
    std::optional<Asked> asked;  ///< without a drive: the robot is kept for it
    double round_trip_s = 0;
    MonotonicTime timed;  ///< when the row was given it
  };
  /// How much a client may still say.
  struct Allowance {
    double words = kWordsPerSecond;
    MonotonicTime counted;
    std::optional<MonotonicTime> begun;
  };

  Status admit(const Driver& driver, const std::string& robot, Now now);
  void begin(const Driver& driver, DriveWord word, Now now);
  void go_on(Drive& drive, DriveWord word, Now now);
  [[nodiscard]] std::optional<Error> why_not_begin(const Driver& driver, const DriveWord& word, Now now);
  void order(Drive& drive, const DriveWord& word, Now now);
  void end(const std::string& id, const std::string& outcome, std::optional<Error> error, bool notify_node, Now now);
  void refuse(const Driver& driver, const DriveWord& word, Error error);
  void show(const std::string& id, Now now);
  void note(const Driver& driver, std::string action, std::string about, std::string outcome);
  void end_overdue(Now now);

  RowBook& book_;
  std::map<std::string, Robot> robots_;
  std::map<ClientId, std::string> driven_;  ///< by each client that drives
  std::map<ClientId, Allowance> allowances_;
  std::uint64_t last_drive_ = 0;
  DriveEffects effects_;
};

}  // namespace trb::gateway
