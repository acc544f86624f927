#include "services/cli/conform/play.hpp"

#include <cmath>
#include <cstdio>
#include <sstream>

#include "common/transport/loop.hpp"

namespace trb::cli::conform {
namespace {

constexpr const char* kRequester = "conform";
constexpr std::array<const char*, 4> kHead = {"type", "subtype", "source", "size"};

std::string short_seconds(Duration duration) {
  char text[32];
  std::snprintf(text, sizeof text, "%g s", to_seconds(duration));
  return text;
}

std::string name_of(const Said& said) {
  return said.type + " " + said.subtype + " to " + (said.target.empty() ? "its own node" : said.target) + " with " +
         shown(said.data);
}

std::string name_of(const Received& received) {
  switch (received.kind) {
    case Received::Kind::ok:
      return "an acknowledgement";
    case Received::Kind::stopped:
      return "the confirmation of a stop";
    case Received::Kind::released:
      return "the confirmation of a release";
    case Received::Kind::said:
      return name_of(received.said);
    case Received::Kind::closed:
      return "the robot closed the connection";
    case Received::Kind::silence:
      return "nothing";
    case Received::Kind::nonsense:
      break;
  }
  return received.text;
}

/// Numbers may come back written in another way.
bool same_numbers(const std::string& a, const std::string& b) {
  std::istringstream left(a), right(b);
  double x = 0, y = 0;
  while (left >> x) {
    if (!(right >> y) || std::abs(x - y) > 1e-6 * (1 + std::abs(x))) return false;
  }
  return left.eof() && !(right >> y) && right.eof();
}

std::string requester_of(const FieldChannel& channel, const std::string& own_id) {
  if (channel.encoding == Encoding::text) return kRequester;
  for (const auto& [id, ignored] : channel.id_codes) {
    if (id != own_id) return id;
  }
  return own_id;
}

}  // namespace

Play::Play(RobotEnd& end, const Settings& settings)
    : end_(end),
      settings_(settings),
      words_(settings_.channel, settings_.own_id),
      requester_(requester_of(settings_.channel, settings_.own_id)),
      cutter_(settings_.channel),
      collector_(words_, settings_.channel.framing == Framing::delay) {}

void Play::begin() {
  result_.reset();
  if (end_.connected()) return;
  const Duration patience = was_there_ ? settings_.patience : settings_.first_dial;
  cutter_.clear();
  fields_.clear();
  collector_.restart();
  inbox_.clear();
  if (!end_.accept(settings_.from, patience)) {
    const std::string who = settings_.from.empty() ? "a robot" : "the robot at " + settings_.from;
    return wrong(who + (was_there_ ? " dials again within " : " dials within ") + short_seconds(patience), "nobody");
  }
  was_there_ = true;
}

CaseResult Play::end() {
  // What a robot that was wrong still says belongs to no later case.
  if (result_ && result_->kind == CaseResult::Kind::wrong) end_.drop();
  return result_.value_or(CaseResult{});
}

void Play::wrong(std::string expected, std::string came) {
  if (going()) result_ = CaseResult{CaseResult::Kind::wrong, std::move(expected), std::move(came)};
}

void Play::not_tried(std::string why) {
  if (going()) result_ = CaseResult{CaseResult::Kind::not_tried, "", std::move(why)};
}

// ---- what the middleware does

std::vector<std::string> Play::fields(const std::string& type, const std::string& subtype, const std::string& data) {
  const auto word = words_.subtype(subtype);
  if (!word) {
    not_tried("'" + subtype + "' has no number in field_channel.codes.subtypes");
    return {};
  }
  std::vector<std::string> out;
  for (const std::string& field : {*words_.type(type), *word, *words_.id(requester_), std::to_string(data.size())}) {
    out.push_back(framed(field, settings_.channel));
  }
  const bool unseen = delayed() && data.empty();
  if (unseen) return out;
  for (std::string& chunk : chunks_of(data, settings_.channel)) out.push_back(std::move(chunk));
  return out;
}

void Play::send(const std::string& type, const std::string& subtype, const std::string& data) {
  send_part(type, subtype, data, std::string::npos);
}

void Play::send_part(const std::string& type, const std::string& subtype, const std::string& data, std::size_t most) {
  if (!going()) return;
  const std::vector<std::string> all = fields(type, subtype, data);
  for (std::size_t i = 0; i < std::min(all.size(), most) && going(); ++i) {
    const Received early = receive(Duration::zero());
    if (early.kind == Received::Kind::said) inbox_.push_back(early.said);
    const std::string name = i < kHead.size() ? kHead[i] : "chunk " + std::to_string(i - kHead.size() + 1);
    if (early.kind == Received::Kind::ok) return wrong("no acknowledgement before the field '" + name + "'", "one");
    write(all[i]);
    if (acknowledged()) expect_ok("the field '" + name + "' of a " + type + " " + subtype);
  }
}

void Play::send_at_once(const std::vector<std::vector<std::string>>& messages) {
  std::string bytes;
  for (const auto& message : messages) {
    for (const std::string& field : message) bytes += field;
  }
  write(bytes);
}

void Play::raw(const std::string& bytes) {
  write(bytes);
}

void Play::write(const std::string& bytes) {
  if (!going()) return;
  std::string received;
  if (!end_.write(bytes, received, settings_.patience)) {
    return wrong("the robot reads",
                 "it closed the connection, or took nothing for " + short_seconds(settings_.patience));
  }
  cutter_.add(received);
  // Also who speaks has to listen all the time: a pause that is missed is a border that is lost.
  const MonotonicTime end = read_clocks().mono + seconds(settings_.channel.delay_s);
  for (Duration left{1}; delayed() && left > Duration::zero(); left = end - read_clocks().mono) pump(left);
}

void Play::break_off() {
  if (!going()) return;
  end_.drop();
  begin();
}

// ---- what the robot should do

Play::Came Play::pump(Duration patience) {
  const bool held = delayed() && !cutter_.held().empty();
  std::string bytes;
  if (!end_.read(bytes, held ? seconds(settings_.channel.delay_s / 2) : patience)) return Came::end;
  cutter_.add(bytes);
  const std::size_t before = fields_.size();
  for (bool pause = held && bytes.empty(); auto field = cutter_.next(pause); pause = false) fields_.push_back(*field);
  return bytes.empty() && fields_.size() == before ? Came::nothing : Came::something;
}

Received Play::receive(Duration patience) {
  MonotonicTime deadline = read_clocks().mono + patience;
  while (true) {
    if (!fields_.empty()) {
      const Field field = std::move(fields_.front());
      fields_.pop_front();
      if (!field.fault.empty()) return {Received::Kind::nonsense, {}, field.fault};
      if (auto received = collector_.take(field.text)) return std::move(*received);
      continue;
    }
    const Came came = pump(std::max(Duration::zero(), deadline - read_clocks().mono));
    if (came == Came::end) return {Received::Kind::closed, {}, ""};
    if (came == Came::nothing) return {Received::Kind::silence, {}, ""};
    deadline = read_clocks().mono + patience;
  }
}

Received Play::next(Duration patience) {
  if (inbox_.empty()) return receive(patience);
  Received received{Received::Kind::said, std::move(inbox_.front()), ""};
  inbox_.pop_front();
  return received;
}

void Play::expect_ok(const std::string& after) {
  while (going()) {
    const Received received = receive(ack_patience());
    if (received.kind == Received::Kind::ok) return;
    if (received.kind == Received::Kind::said) {
      inbox_.push_back(received.said);
      continue;
    }
    wrong("'" + words_.ok() + "' after " + after + " within " + short_seconds(ack_patience()), name_of(received));
  }
}

void Play::expect_stopped() {
  expect_order(Received::Kind::stopped, words_.stopped());
}

void Play::expect_released() {
  expect_order(Received::Kind::released, words_.released());
}

void Play::expect_order(Received::Kind wanted, const std::string& word) {
  while (going()) {
    const Received received = receive(ack_patience());
    if (received.kind == wanted) return;
    if (received.kind == Received::Kind::said) {
      inbox_.push_back(received.said);
      continue;
    }
    // An acknowledgement that was under way before the confirmation counts for nothing.
    if (received.kind == Received::Kind::ok && wanted == Received::Kind::stopped) continue;
    wrong("'" + word + "' within " + short_seconds(ack_patience()), name_of(received));
  }
}

void Play::expect_answer(const std::string& subtype, const std::string& data) {
  const std::string to = requester_ == settings_.own_id ? "" : requester_;
  const std::string expected = name_of(Said{"information", subtype, to, data});
  while (going()) {
    const Received received = next(settings_.patience);
    const Said& said = received.said;
    if (received.kind != Received::Kind::said) return wrong(expected, name_of(received));
    if (said.subtype != subtype) continue;  // a report or a fault of its own
    const bool same = words_.numeric() ? same_numbers(said.data, data) : said.data == data;
    if (said.type != "information" || said.target != to || !same) wrong(expected, name_of(said));
    return;
  }
}

void Play::expect_quiet(Duration duration, const std::string& why) {
  while (going()) {
    const Received received = receive(duration);
    if (received.kind == Received::Kind::silence) return;
    if (received.kind != Received::Kind::said) return wrong(why, name_of(received));
    inbox_.push_back(received.said);
  }
}

std::string Play::report(Duration patience) {
  const auto skill = words_.subtype(settings_.skill);
  const MonotonicTime end = read_clocks().mono + patience;
  while (going()) {
    const Received received = next(std::max(Duration::zero(), end - read_clocks().mono));
    if (received.kind == Received::Kind::silence) return {};
    if (received.kind != Received::Kind::said) {
      wrong("'done' or 'failed' of " + settings_.skill, name_of(received));
      return {};
    }
    const Said& said = received.said;
    if (said.subtype != "done" && said.subtype != "failed") continue;
    const std::string word = said.data.substr(0, said.data.find(' '));
    if (said.type == "information" && said.target.empty() && word == skill.value_or("")) {
      return said.subtype + said.data.substr(word.size());
    }
    wrong("information done to its own node with '" + skill.value_or("") + "' first", name_of(said));
  }
  return {};
}

// ---- both

void Play::learn_how_it_answers() {
  const std::string data = words_.numeric() ? "7" : "ping";
  send("request", settings_.echo, data);
  if (!going()) return;
  answers_ = Answers::none;
  while (true) {
    const Received received = next(settings_.patience);
    if (received.kind == Received::Kind::silence) return;
    if (received.kind != Received::Kind::said)
      return wrong("an answer to the request " + settings_.echo, name_of(received));
    no_answer_ = name_of(received);
    if (received.said.subtype != settings_.echo) continue;
    const bool same = words_.numeric() ? same_numbers(received.said.data, data) : received.said.data == data;
    answers_ = same ? Answers::echo : Answers::other;
    return;
  }
}

void Play::expect_answers() {
  if (answers_ == Answers::not_asked) learn_how_it_answers();
  if (answers_ == Answers::none) wrong("information " + settings_.echo + " to " + requester_, no_answer_);
  still_understands();
}

void Play::echo(const std::string& data) {
  if (!going()) return;
  if (answers_ == Answers::not_asked) learn_how_it_answers();
  if (answers_ != Answers::echo) {
    return not_tried("the robot does not answer the request '" + settings_.echo +
                     "' with its data, so nobody sees what "
                     "it understands");
  }
  send("request", settings_.echo, data);
  expect_answer(settings_.echo, data);
}

void Play::still_understands() {
  if (!going()) return;
  if (answers_ == Answers::not_asked) learn_how_it_answers();
  if (!going()) return;
  const std::string number = std::to_string(1000 + ++pings_);
  const std::string data = words_.numeric() ? number : "ping " + number;
  send("request", settings_.echo, data);
  if (answers_ == Answers::echo) expect_answer(settings_.echo, data);
  if (answers_ == Answers::other) expect_answer(settings_.echo, words_.unknown());
  if (answers_ == Answers::none && !acknowledged()) not_tried("the robot tells nothing of what it has taken");
}

}  // namespace trb::cli::conform
