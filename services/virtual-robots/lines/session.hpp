#pragma once

#include <deque>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "services/virtual-robots/lines/framing.hpp"
#include "services/virtual-robots/lines/message.hpp"
#include "services/virtual-robots/lines/vocabulary.hpp"

namespace trb::virtual_robots::lines {

struct FieldReceived {
  std::size_t index = 0;
  std::string text;
};
struct MessageReceived {
  Message message;
};
struct StopReceived {};
struct ReleaseReceived {};
/** Something that the node must not do, or a word that the robot cannot send; the connection may go on. */
struct Violation {
  std::string what;
};

using SessionEvent = std::variant<FieldReceived, MessageReceived, StopReceived, ReleaseReceived, Violation>;

struct SessionSettings {
  FrameRules frame;
  Vocabulary vocabulary;
  bool acknowledge = true;
  /** Means "my own node" with the delay framing, where an empty field cannot be sent. */
  std::string own_name;
  /** After this many messages it stops reading; 0: never. */
  std::size_t hang_after = 0;
};

/** The robot's end of a field channel: bytes and time in, bytes and events out. `now` is real time in seconds. */
class Session {
 public:
  static constexpr std::size_t kLargestMessage = std::size_t{16} * 1024 * 1024;
  static constexpr std::size_t kLargestOutput = std::size_t{4} * 1024 * 1024;

  explicit Session(SessionSettings settings) : settings_(std::move(settings)), reader_(settings_.frame) {}

  /** Drops the unfinished messages of the last connection. */
  void restart();

  void receive(std::string_view bytes, double now);

  /** Takes the fields that are complete because time has passed. */
  void advance(double now);

  void send(const Message& message);

  /** The bytes that may be written now; with the delay framing one field at a time. */
  std::string take_output(double now);

  std::optional<double> next_deadline() const;
  std::vector<SessionEvent> take_events() { return std::exchange(events_, {}); }

  /** Why the connection must be closed; empty while all is well. */
  const std::string& fault() const { return fault_; }
  bool hung() const { return hung_; }

 private:
  void take_field(const Field& field);
  void take_part(const std::string& text);
  void take_size(const std::string& text);
  void take_chunk(const std::string& text);
  void finish_message();
  bool take_urgent(const std::string& text);
  void drop_partial();
  void queue_field(std::string_view field) { queue(frame_field(field, settings_.frame)); }
  void queue(std::string framed);
  void emit(SessionEvent event) { events_.push_back(std::move(event)); }
  bool delayed() const { return settings_.frame.framing == Framing::delay; }

  SessionSettings settings_;
  FieldReader reader_;
  Message partial_;
  std::size_t fields_ = 0;
  std::size_t size_ = 0;
  std::size_t messages_ = 0;
  std::deque<std::string> output_;
  std::size_t output_bytes_ = 0;
  double next_output_ = 0;
  std::vector<SessionEvent> events_;
  std::string fault_;
  bool hung_ = false;
};

}  // namespace trb::virtual_robots::lines
