// Messages on their way to a robot on the field channel: a bounded queue, one field at a time, a stop before all
// others.
#pragma once

#include <deque>

#include "common/drivers/driver.hpp"
#include "common/drivers/lines/field_text.hpp"

namespace trb::drivers {

struct Outgoing {
  Token token = 0;
  std::string subtype;
  FieldHead head;
  Bytes data;
};

/// state          | enqueue      | ok                | urgent                | urgent-done     | deadline
/// ---------------|--------------|-------------------|-----------------------|-----------------|--------------------
/// idle           | first field  | stray, counted    | written               | stray, counted  | -
/// field written  | queued       | next field        | rest dropped, written | stray, counted  | ack_timeout
/// urgent written | queued       | counts for nothing| written               | idle            | ack_timeout
class FieldSender {
 public:
  FieldSender(const FieldChannel& settings, const FieldText& words);

  /// Errors: queue_full.
  Status enqueue(Outgoing message, Now now, const DriverOut& out);
  /// True while the message is not wholly handed over.
  [[nodiscard]] bool holds(Token token) const;
  [[nodiscard]] bool urgent_pending() const { return !urgents_.empty(); }
  /// Drops a message of which no field has been sent.
  bool remove(Token token);
  /// Everything that waits is Refused; the robot must discard an incomplete message.
  void drop_all(const Error& why, const DriverOut& out);
  /// The message whose fields are being sent is Refused, unless it is `halted`: the robot may have it whole.
  void drop_current(Token halted, const Error& why, const DriverOut& out);

  void urgent(Urgent urgent, Token ticket, Now now, const DriverOut& out);
  void on_ok(Now now, const DriverOut& out);
  /// The ticket that the robot has confirmed, if it was asked for that.
  std::optional<Token> on_urgent_done(Urgent urgent, Now now, const DriverOut& out);

  /// Writes what is due. False: the robot has not acknowledged in time, the connection can no longer be used.
  [[nodiscard]] bool tick(Now now, const DriverOut& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const;

  /// A new connection: nothing is in progress.
  void restart();

 private:
  struct UrgentOrder {
    Urgent urgent{};
    Token ticket = 0;
    bool written = false;
    MonotonicTime deadline;
  };

  void drop_unwritten(Urgent next);
  [[nodiscard]] bool delayed() const { return settings_.framing == Framing::delay; }
  [[nodiscard]] bool acknowledged() const { return settings_.acknowledge && !delayed(); }
  [[nodiscard]] bool slot_free(Now now) const { return !delayed() || now.mono >= slot_; }
  [[nodiscard]] bool may_begin(Now now) const;
  [[nodiscard]] bool urgent_waits() const;
  [[nodiscard]] bool whole() const;
  void pump(Now now, const DriverOut& out);
  void write_urgents(Bytes& bytes, Now now, const DriverOut& out);
  void write_field(Bytes& bytes, Now now, const DriverOut& out);
  void finish_current(const DriverOut& out);
  void begin_next();

  FieldChannel settings_;
  const FieldText& words_;
  std::deque<Outgoing> queue_;  ///< the first one is being sent once field_ > 0
  std::size_t queued_bytes_ = 0;
  std::size_t field_ = 0;   ///< fields of the first message written
  std::size_t offset_ = 0;  ///< bytes of its data written
  bool waits_for_ok_ = false;
  MonotonicTime ok_deadline_;
  MonotonicTime slot_;  ///< with `delay`: when the next field may be sent
  std::deque<UrgentOrder> urgents_;
};

}  // namespace trb::drivers
