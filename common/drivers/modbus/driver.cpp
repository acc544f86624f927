#include "common/drivers/modbus/driver.hpp"

#include <algorithm>

#include "common/drivers/modbus/data.hpp"
#include "common/drivers/modbus/exception.hpp"

namespace trb::drivers {
namespace {

constexpr std::size_t kMaxJobs = 64;
constexpr const char* kWouldNotStop = "stop refused";
constexpr std::string_view kPosition = "position";

// What cannot be read was a fault of commands.json, which keeps the node from starting.
ModbusPlaces places_of(const VendorCommands& words) {
  ModbusPlaces places;
  for (const auto& [name, text] : words.values) {
    if (const auto place = read_modbus_place(text)) places[name] = *place;
  }
  return places;
}

ModbusPlaces polled_of(const VendorCommands& words, const Description& description) {
  const ModbusPlaces places = places_of(words);
  ModbusPlaces polled;
  const auto add = [&](const std::string& name) {
    const auto request = words.requests.find(name);
    const auto place = places.find(request == words.requests.end() ? name : request->second);
    if (place != places.end()) polled.insert(*place);
  };
  for (const auto& [subtype, name] : words.requests) add(subtype);
  for (const FaultRule& rule : description.faults) add(rule.value);
  for (const std::string& name : description.sensors) add(name);
  for (const Skill& skill : description.skills) {
    if (skill.end.kind != EndKind::state && skill.end.kind != EndKind::position) continue;
    add(skill.end.state.empty() ? std::string(kPosition) : skill.end.state);
  }
  return polled;
}

/// Where the stop writes: the one place that every device surely has.
ModbusPlace probe_of(const VendorCommands& words) {
  const auto stop = words.commands.find("stop");
  if (stop == words.commands.end()) return {};
  const auto read = read_modbus_assignments(stop->second, places_of(words));
  return read && !read->empty() ? read->front().place : ModbusPlace{};
}

}  // namespace

ModbusDriver::ModbusDriver(const VendorCommands& words, const Description& description, std::string own_id)
    : own_id_(std::move(own_id)),
      requests_(words.requests.begin(), words.requests.end()),
      poll_(polled_of(words, description), probe_of(words), seconds(modbus_settings(words).poll_s)) {
  const ModbusPlaces places = places_of(words);
  for (const auto& [subtype, text] : words.commands) {
    if (auto read = read_modbus_assignments(text, places)) commands_[subtype] = std::move(*read);
  }
}

bool ModbusDriver::knows(MessageType type, std::string_view subtype) const {
  if (type == MessageType::command) return commands_.contains(subtype);
  return type == MessageType::request && requests_.contains(subtype);
}

std::string_view ModbusDriver::name_of_value(std::string_view name) const {
  const auto request = requests_.find(name);
  return request == requests_.end() ? name : std::string_view(request->second);
}

const RobotValue* ModbusDriver::value(std::string_view name) const {
  const ModbusPoll::Known* known = poll_.find(name_of_value(name));
  return known == nullptr || !known->value ? nullptr : &*known->value;
}

Result<std::vector<ModbusDriver::Write>> ModbusDriver::fill(std::string_view subtype, BytesView data) const {
  const auto found = commands_.find(subtype);
  if (found == commands_.end()) return fail(Errc::unknown_subtype, "commands.json has no such command");
  std::vector<Write> out;
  for (const ModbusAssignment& one : found->second) {
    const auto number = modbus_data(one, data);
    if (!number) return number.error();
    const std::string meant = one.name + " (" + to_text(one.place) + ")";
    auto words = modbus_words(one.place, *number);
    if (!words) return fail(words.error().code, meant + ": " + words.error().what, words.error().cure);
    out.push_back({meant, one.place, std::move(*words)});
  }
  return out;
}

Result<Progress> ModbusDriver::hand_over(const Handover& message, Now now, const DriverOut& out) {
  if (!online()) {
    return fail(Errc::robot_offline, "the robot's controller is not connected",
                "look at its power, network and address");
  }
  if (jobs_.size() >= kMaxJobs) return fail(Errc::queue_full, "too many commands wait for the device", "send fewer");
  auto writes = fill(message.subtype, message.data);
  if (!writes) return writes.error();
  if (writes->empty()) return Progress::handed_over;
  out.out.count("to_robot." + std::string(message.subtype));
  jobs_.push_back({Purpose::command, message.token, !message.skill.empty(), std::move(*writes), 0});
  pump(now, out);
  return Progress::queued;
}

std::optional<Error> ModbusDriver::problem(std::string_view name) const {
  const ModbusPoll::Known* known = poll_.find(name_of_value(name));
  return known == nullptr ? std::nullopt : known->problem;
}

bool ModbusDriver::runs(Token token) const {
  return std::ranges::any_of(jobs_,
                             [&](const Job& job) { return job.purpose == Purpose::command && job.token == token; });
}

void ModbusDriver::forget(Token token, Now, const DriverOut&) {
  const auto waiting = jobs_.begin() + (awaits_ == Awaits::job ? 1 : 0);
  const auto job = std::find_if(waiting, jobs_.end(), [&](const Job& one) {
    return one.purpose == Purpose::command && one.token == token && one.done == 0;
  });
  if (job != jobs_.end()) jobs_.erase(job);
}

void ModbusDriver::halt(Token token, Now now, const DriverOut& out) {
  const auto job = std::ranges::find_if(
      jobs_, [&](const Job& one) { return one.purpose == Purpose::command && one.token == token; });
  if (job != jobs_.end()) {
    const bool under_way = awaits_ == Awaits::job && job == jobs_.begin();
    const bool begun = under_way || job->done > 0;
    if (under_way) awaits_ = Awaits::nobody;
    jobs_.erase(job);
    if (!begun) return;  // nothing of it has been written: there is no motion to end
  }
  if (!up_) return;
  auto writes = fill("stop", {});
  if (!writes || writes->empty()) {
    return out.refuse("no_stop", "commands.json has no \"stop\" for this robot: the motion goes on");
  }
  out.out.count("to_robot.stop");
  push_urgent({Purpose::halt, 0, false, std::move(*writes), 0});
  pump(now, out);
}

Result<Token> ModbusDriver::stop(Now now, const DriverOut& out) {
  drop_for_stop(out);
  if (!up_) return fail(Errc::robot_offline, "the robot's controller is not connected");
  auto writes = fill("stop", {});
  if (!writes || writes->empty()) return fail(Errc::unknown_subtype, "commands.json has no \"stop\" for this robot");
  told_to_stop_ = true;
  const Token ticket = ++last_ticket_;
  const auto waits = std::ranges::find_if(jobs_, [&](const Job& job) {
    return job.purpose == Purpose::stop && (awaits_ != Awaits::job || &job != &jobs_.front());
  });
  if (waits != jobs_.end()) {
    waits->token = ticket;  // one that has not begun is the same stop
    return ticket;
  }
  out.out.count("to_robot.stop");
  push_urgent({Purpose::stop, ticket, false, std::move(*writes), 0});
  pump(now, out);
  return ticket;
}

/// Everything but stops. What is under way is on its way; nobody hears its answer any more.
void ModbusDriver::drop_for_stop(const DriverOut& out) {
  if (awaits_ == Awaits::job && jobs_.front().purpose != Purpose::stop) awaits_ = Awaits::nobody;
  for (const Job& job : jobs_) {
    if (job.purpose != Purpose::command) continue;
    const std::string written = std::to_string(job.done) + " of its " + std::to_string(job.writes.size()) + " writes";
    out.emit(Refused{job.token, fail(Errc::fenced, "the robot was stopped when the device had acknowledged " + written,
                                     "trb release " + own_id_)});
  }
  std::erase_if(jobs_, [](const Job& job) { return job.purpose != Purpose::stop; });
}

void ModbusDriver::push_urgent(Job job) {
  auto at = jobs_.begin() + (awaits_ == Awaits::job ? 1 : 0);
  while (at != jobs_.end() && at->purpose == Purpose::stop) ++at;
  jobs_.insert(at, std::move(job));
}

Result<Token> ModbusDriver::release(Now now, const DriverOut& out) {
  if (!up_) return fail(Errc::robot_offline, "the robot's controller is not connected");
  told_to_stop_ = false;
  const Token ticket = ++last_ticket_;
  auto writes = fill("release", {});
  if (!writes || writes->empty()) {
    out.emit(Released{ticket});
    return ticket;
  }
  out.out.count("to_robot.release");
  push_urgent({Purpose::release, ticket, false, std::move(*writes), 0});
  pump(now, out);
  return ticket;
}

void ModbusDriver::pump(Now now, const DriverOut& out) {
  if (!up_ || awaits_ != Awaits::nothing) return;
  const bool polls = now.mono >= poll_.due();
  const bool urgent = !jobs_.empty() && jobs_.front().purpose != Purpose::command;
  // Commands that never cease must not keep the values from being told, nor the other way round.
  if (polls && (jobs_.empty() || (!urgent && !polled_last_))) return call(poll_.call(), Awaits::poll, out);
  if (jobs_.empty()) return;
  const Job& job = jobs_.front();
  const Write& write = job.writes[job.done];
  call({true, write.place.kind, write.place.address, 0, write.words}, Awaits::job, out);
}

void ModbusDriver::call(const ModbusCall& what, Awaits whose, const DriverOut& out) {
  awaits_ = whose;
  polled_last_ = whose == Awaits::poll;
  out.out.write(Channel::command, encode(what));
}

void ModbusDriver::on_up(Channel channel, Now now, const DriverOut& out) {
  if (channel != Channel::command) return;
  up_ = true;
  heard_ = polled_last_ = false;
  awaits_ = Awaits::nothing;
  poll_.restart(now);
  pump(now, out);
}

void ModbusDriver::on_bytes(Channel channel, BytesView bytes, Now now, const DriverOut& out) {
  if (channel != Channel::command || !up_) return;
  const auto answer = decode_modbus_answer(bytes);
  const Awaits whose = answer ? std::exchange(awaits_, Awaits::nothing) : Awaits::nothing;
  if (whose == Awaits::nothing) return out.refuse("bad_packet", "an answer that nobody has asked for");
  if (whose == Awaits::poll) on_poll(*answer, now, out);
  if (whose == Awaits::job) on_write(*answer, out);
  if (!std::exchange(heard_, true)) out.emit(LinkUp{});
  pump(now, out);
}

void ModbusDriver::on_poll(const ModbusAnswer& answer, Now now, const DriverOut& out) {
  const ModbusPoll::News news = poll_.on_answer(answer, now);
  for (const Error& problem : news.problems) {
    out.emit(FaultSaid{"", Severity::warning, problem.what + "; " + problem.cure});
  }
  if (news.values) out.emit(ValuesHeard{});
}

void ModbusDriver::on_write(const ModbusAnswer& answer, const DriverOut& out) {
  Job& job = jobs_.front();
  if (answer.exception == 0 && ++job.done < job.writes.size()) return;
  const Job ended = std::move(job);
  jobs_.pop_front();
  if (answer.exception != 0) return on_exception(ended, answer.exception, out);
  on_done(ended, out);
}

void ModbusDriver::on_done(const Job& job, const DriverOut& out) {
  if (job.purpose == Purpose::stop) {
    out.emit(Stopped{job.token, true});
    out.emit(FaultOver{kWouldNotStop});
  }
  if (job.purpose == Purpose::release) out.emit(Released{job.token});
  if (job.purpose != Purpose::command) return;
  out.out.count("from_robot.done");
  out.emit(HandedOver{job.token});
  if (job.skill) out.emit(Ended{job.token, true, {}});
}

void ModbusDriver::on_exception(const Job& job, std::uint8_t exception, const DriverOut& out) {
  Error error = modbus_exception(exception, job.writes[job.done].meant);
  if (job.done > 0) error.what += "; the " + std::to_string(job.done) + " writes before it were done";
  if (job.purpose == Purpose::command) return out.emit(Refused{job.token, error});
  out.refuse("robot_error", error.text());
  // Its asker is told at its deadline that nothing was confirmed; everybody else must know at once.
  if (job.purpose != Purpose::release) {
    out.emit(FaultSaid{"", Severity::critical, "the device refused to stop: " + error.what, kWouldNotStop, false});
  }
}

void ModbusDriver::on_down(Channel channel, const std::string& reason, Now now, const DriverOut& out) {
  if (channel != Channel::command) return;
  const bool was_online = online();
  const bool under_way = std::exchange(awaits_, Awaits::nothing) == Awaits::job;
  up_ = heard_ = false;
  poll_.restart(now);
  bool first = true;
  for (const Job& job : std::exchange(jobs_, {})) {
    if (job.purpose == Purpose::command) out.emit(Refused{job.token, lost(job, under_way && first, reason)});
    first = false;
  }
  if (was_online) out.emit(LinkDown{reason});
}

Error ModbusDriver::lost(const Job& job, bool under_way, const std::string& reason) {
  if (!under_way && job.done == 0) {
    return fail(Errc::robot_offline, "the connection was lost before the command was written: " + reason,
                "look at the device's power and network, then send it again");
  }
  return fail(Errc::robot_offline,
              "the connection was lost while " + job.writes[job.done].meant +
                  " was written, and nobody knows whether the device took it: " + reason,
              "look at the device before you send it again");
}

std::optional<MonotonicTime> ModbusDriver::next_deadline() const {
  if (!up_ || awaits_ != Awaits::nothing) return std::nullopt;
  return poll_.due();
}

}  // namespace trb::drivers
