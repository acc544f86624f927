#include "services/virtual-robots/lines/virtual_lines.hpp"

#include <algorithm>
#include <array>

#include "services/virtual-robots/lines/reports.hpp"
#include "services/virtual-robots/support/text.hpp"

namespace trb::virtual_robots::lines {
namespace {

/** Messages kept while there is no connection; the oldest are dropped first. */
constexpr std::size_t kMostHeld = 64;

}  // namespace

VirtualLines::VirtualLines(const Settings& settings)
    : settings_(settings),
      clock_(settings.speed),
      link_(settings.node, settings.source),
      session_(settings.session),
      body_(settings.body),
      console_(settings.control) {}

void VirtualLines::run(const Fd& end) {
  console_.announce("");
  while (!quit_) {
    link_.dial(wall_seconds());
    std::vector<pollfd> polled = console_.to_poll(end);
    polled.push_back(poll_entry());
    if (!Console::wait(polled, next_deadline())) return;
    if (polled.back().revents != 0) serve_link(polled.back().revents);
    for (const std::string& line : console_.read(polled)) take_console_line(line);
    flush_lines();
    step();
  }
}

pollfd VirtualLines::poll_entry() const {
  if (link_.state() == Link::State::connecting) return {link_.fd(), POLLOUT, 0};
  const int reading = may_read() ? POLLIN : 0;
  const int writing = link_.has_output() ? POLLOUT : 0;
  // A slow reader must not poll for a hang-up before it may read, or poll would return at once again and again.
  const bool asleep = reading == 0 && writing == 0 && !session_.hung();
  return {asleep ? -1 : link_.fd(), static_cast<short>(reading | writing), 0};
}

void VirtualLines::serve_link(short found) {
  if (link_.state() == Link::State::connecting) {
    if (!link_.finish_dial(wall_seconds())) return;
    session_.restart();
    print_line("connected");
    for (const Message& message : std::exchange(held_, {})) session_.send(message);
  } else if (may_read() && (found & (POLLIN | POLLHUP | POLLERR))) {
    read_link();
  } else if (found & (POLLHUP | POLLERR)) {
    disconnect("closed_by_node");
  }
}

void VirtualLines::read_link() {
  std::string bytes;
  const bool alive = link_.read(bytes);
  next_read_ = wall_seconds() + settings_.slow_read_s;
  session_.receive(bytes, wall_seconds());
  if (!alive) disconnect("closed_by_node");
}

void VirtualLines::disconnect(std::string_view reason) {
  take_session_events();
  link_.close(wall_seconds());
  session_.restart();
  print_line("disconnected " + std::string(reason));
}

void VirtualLines::take_console_line(const std::string& line) {
  std::string_view words = line;
  const std::string_view order = take_word(words);
  std::optional<Message> message;
  if (order == "quit") {
    quit_ = true;
    return;
  }
  if (order == "clear") return clear_faults();
  if (order == "drop") {
    if (link_.state() == Link::State::up) disconnect("dropped");
    return;
  }
  if (order == "say") message = parse_say(words);
  if (order == "fault") message = take_fault(words);
  if (message) {
    say(*message);
  } else {
    print_line("unknown_line");
  }
}

std::optional<Message> VirtualLines::take_fault(std::string_view words) {
  auto message = parse_fault(words, settings_.session.vocabulary);
  const auto order = parse_fault_order(words);
  if (order && faults_.size() < kMostHeld) faults_.insert(order->capability);
  return message;
}

void VirtualLines::clear_faults() {
  for (const std::string& capability : std::exchange(faults_, {})) {
    say(fault_over(capability, settings_.session.vocabulary));
  }
  print_line("cleared");
}

void VirtualLines::say(const Message& message) {
  if (link_.state() == Link::State::up) return session_.send(message);
  held_.push_back(message);
  if (held_.size() <= kMostHeld) return;
  print_line("lost " + escape_line(held_.front().subtype) + " " + escape_line(held_.front().data));
  held_.pop_front();
}

void VirtualLines::step() {
  session_.advance(wall_seconds());
  take_session_events();
  body_.advance(clock_.now());
  take_body_events();
  take_session_events();
  if (link_.state() == Link::State::up) write_link();
}

void VirtualLines::take_session_events() {
  for (const SessionEvent& event : session_.take_events()) {
    print_line(line_of(event));
    if (const auto* received = std::get_if<MessageReceived>(&event)) body_.take(received->message, clock_.now());
    if (std::holds_alternative<StopReceived>(event)) body_.stop(clock_.now());
    if (std::holds_alternative<ReleaseReceived>(event)) body_.release();
    take_body_events();
  }
}

void VirtualLines::take_body_events() {
  for (const BodyEvent& event : body_.take_events()) {
    if (const auto line = line_of(event)) print_line(*line);
    if (const auto message = message_of(event, settings_.session.vocabulary)) say(*message);
  }
}

void VirtualLines::write_link() {
  if (!link_.has_output()) link_.add_output(session_.take_output(wall_seconds()));
  if (!link_.flush()) return disconnect("closed_by_node");
  if (!session_.fault().empty()) disconnect(std::string(session_.fault()));
}

double VirtualLines::next_deadline() const {
  double deadline = clock_.deadline(body_.next_deadline());
  if (link_.state() == Link::State::waiting) return std::min(deadline, link_.retry_at());
  if (link_.state() == Link::State::connecting) return deadline;
  if (const auto session = session_.next_deadline(); session && !link_.has_output()) {
    deadline = std::min(deadline, *session);
  }
  return session_.hung() || may_read() ? deadline : std::min(deadline, next_read_);
}

}  // namespace trb::virtual_robots::lines
