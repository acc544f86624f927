#include "services/cloud-gateway/io/process.hpp"

#include <boost/asio/executor_work_guard.hpp>

#include "common/log/log.hpp"
#include "services/cloud-gateway/io/api/once.hpp"
#include "services/cloud-gateway/io/drive_desk.hpp"
#include "services/cloud-gateway/io/fresh.hpp"
#include "services/cloud-gateway/io/http/tls_files.hpp"
#include "services/cloud-gateway/io/json_messages.hpp"
#include "services/cloud-gateway/io/live_socket.hpp"
#include "services/cloud-gateway/io/loop_bridge.hpp"
#include "services/cloud-gateway/io/simulation_runner.hpp"

namespace trb::gateway {
namespace {

/// Expired sessions and keys, commits of what reads have changed.
constexpr Duration kHouse = std::chrono::seconds(5);
/// A session that is ended at another gateway ends here within a second, also if nobody sends a request.
constexpr Duration kLook = std::chrono::milliseconds(400);
/// Who signs out, is disabled or has another role sees nothing more after so long; 1,000 streams cost a few ms.
constexpr Duration kCheckRights = std::chrono::milliseconds(400);
/// How soon a disk that has room again is noticed.
constexpr Duration kTryDisk = std::chrono::seconds(1);
/// A page's numbers are exact up to 2^53: it sends the instance back to resume.
constexpr std::uint64_t kExactInJson = (1ULL << 53U) - 1;
/// Looking at the bus costs as much as a short handler.
constexpr int kHandlersInTurn = 16;
constexpr Duration kWarnAgain = std::chrono::hours(24);
constexpr Duration kLastReplies = std::chrono::seconds(2);

LoopBridge::Driven driven_by(Service& service) {
  return {service.descriptor(), [&service] { return service.next_deadline(); },
          [&service] { return service.handle_ready(); }};
}

LoopBridge::Driven driven_by(Loop& loop) {
  return {loop.descriptor(), [&loop] { return loop.next_deadline(); }, [&loop] { return loop.handle_ready(); }};
}

std::string all_of(const std::vector<std::string>& texts) {
  std::string out;
  for (const std::string& one : texts) out += (out.empty() ? "" : " ") + one;
  return out;
}

}  // namespace

Process::Process(Service& service, GatewayDb& db, std::unique_ptr<HistoryStore> history, Access& access,
                 std::string node_dir, Places places, UtcTime certificate_ends)
    : service_(service),
      db_(db),
      access_(access),
      node_dir_(std::move(node_dir)),
      places_(std::move(places)),
      certificate_ends_(certificate_ends),
      passwords_(loop_, kChecksAtOnce),
      view_(book_, access.alarms),
      clients_(book_, encoder_, (service.instance() & kExactInJson) | 1U),
      history_(loop_, std::move(history)),
      core_(book_, view_, access) {
  book_.observe(recorder_);
}

Gateway Process::gateway_of(op::Session& session) {
  return {access_,  db_,       passwords_, session,           book_,   view_, clients_, messages_,
          history_, recorder_, node_dir_,  certificate_ends_, places_, {},    {}};
}

Result<int> Process::run(const HttpServerSettings& settings, const std::vector<std::string>& origins) {
  auto person = op::BusSession::open("gateway");
  if (!person) return person.error();
  const auto tap = open_tap(**person);
  if (!tap) return tap.error();
  Gateway gateway = gateway_of((*person)->session());
  gateway.is_ready = [&person] { return (*person)->is_up(); };
  gateway.on_history_read = [this](const Status& read) {
    history_unread_ = read ? std::nullopt : std::optional(read.error());
  };
  gateway.on_unwritten = [this](const Error& error) { end_unwritten(error); };
  SignIns sign_ins(gateway);
  gateway.sign_ins = &sign_ins;
  op::Doctor doctor((*person)->loop(), &(*person)->session(), nullptr);
  gateway.doctor = &doctor;
  DriveDesk drives(gateway);
  gateway.drives = &drives;
  SimulationRunner simulations(loop_);
  gateway.simulations = &simulations;
  Api api(gateway);
  const auto server = HttpServer::open(loop_, settings, api);
  if (!server) return server.error();
  log_event(Level::info, "listening", all_of(origins));
  service_.start(core_);
  add_timers(gateway, sign_ins);
  drive(**person);
  simulations.stop();
  (*server)->stop();
  answer_last(**person, api);
  for (AuditRecord& record : access_.refusals.take_all(trb::now())) access_.note(std::move(record));
  static_cast<void>(access_.owed() > 0 ? gateway.retry() : gateway.commit());
  write_history(gateway);
  return unwritten_ ? 1 : service_.exit_status();
}

void Process::add_timers(Gateway& gateway, SignIns& sign_ins) {
  service_.timer([this] { return clients_.next_deadline(); }, [this, &gateway](Now) { pump(gateway); });
  service_.timer([this] { return clients_.topics_changed() ? std::optional(MonotonicTime{}) : std::nullopt; },
                 [this](Now now) { follow_topics(now); });
  service_.timer([this] { return access_.sign_in.next_deadline(); }, [&sign_ins](Now) { sign_ins.tick(); });
  service_.timer([&gateway] { return gateway.drives->next_deadline(); },
                 [&gateway](Now now) { gateway.drives->tick(now); });
  service_.timer([&gateway] { return gateway.simulations->desk().next_deadline(); },
                 [&gateway](Now now) { gateway.simulations->tick(now); });
  // A batch that is being written wakes the loop when it is done.
  service_.timer([this] { return history_.is_writing() ? std::nullopt : recorder_.next_deadline(); },
                 [this, &gateway](Now now) { record(gateway, now); });
  service_.timer([this] { return std::optional(house_kept_ + kHouse); },
                 [this, &gateway](Now now) { keep_house(gateway, now); });
  service_.timer([this] { return std::optional(tried_ + kTryDisk); },
                 [this, &gateway](Now now) { try_again(gateway, now); });
  service_.timer(
      [this, &gateway] { return gateway.sockets.empty() ? std::nullopt : std::optional(checked_ + kCheckRights); },
      [this, &gateway](Now now) {
        checked_ = now.mono;
        check_rights(gateway);
      });
  if (!db_.is_shared()) return;
  service_.timer([this] { return std::optional(looked_ + kLook); },
                 [this, &gateway](Now now) {
                   looked_ = now.mono;
                   static_cast<void>(refresh(gateway));
                 });
}

Result<std::unique_ptr<op::Tap>> Process::open_tap(op::BusSession& person) {
  const auto address = tap_address();
  if (!address) return address.error();
  return std::make_unique<op::Tap>(person.context(), person.loop(), *address, op::TapFilter{.all = true},
                                   [this](const op::TapRecord& record) { return on_passed(record); });
}

/// Encoded for the live stream only while somebody looks.
bool Process::on_passed(const op::TapRecord& record) {
  const PassedMessage& passed = messages_.add(record.direction, record.time, record.header);
  if (passed.phase != CostPhase::upkeep && clients_.wants_messages()) clients_.add_message(json_message(passed));
  return true;
}

/// A few handlers, and then what is ready on the bus: deadlines change by either.
void Process::drive(op::BusSession& person) {
  LoopBridge bus(loop_, driven_by(service_));
  LoopBridge asked(loop_, driven_by(person.loop()));
  const auto work = boost::asio::make_work_guard(loop_);
  while (!unwritten_) {
    const MonotonicTime now = trb::now().mono;
    if (!bus.serve(now) || !asked.serve(now)) return;
    const auto due = earlier(bus.next_deadline(), asked.next_deadline());
    if (!due) {
      loop_.run_one();
    } else {
      loop_.run_one_for(std::max(Duration::zero(), *due - trb::now().mono));
    }
    for (int i = 1; i < kHandlersInTurn && !unwritten_ && loop_.poll_one() > 0; ++i) {
    }
  }
}

/// The fleet has still to say what became of requests under way: what it does is answered, and on record.
void Process::answer_last(op::BusSession& person, const Api& api) {
  const MonotonicTime until = trb::now().mono + kLastReplies;
  {
    LoopBridge asked(loop_, driven_by(person.loop()));
    const auto work = boost::asio::make_work_guard(loop_);
    for (MonotonicTime now = trb::now().mono; api.has_open_calls() && now < until; now = trb::now().mono) {
      if (!asked.serve(now)) break;
      const MonotonicTime due = std::min(until, asked.next_deadline().value_or(until));
      loop_.run_one_for(std::max(Duration::zero(), due - trb::now().mono));
    }
  }
  loop_.run_for(std::max(Duration::zero(), until - trb::now().mono));
}

void Process::pump(Gateway& gateway) {
  follow_topics(gateway.now());
  for (const ClientId client : clients_.pump(gateway.now(), view_.silent())) {
    if (const auto at = gateway.sockets.find(client); at != gateway.sockets.end()) at->second->pump();
  }
}

/// What clients watch is requested; what the last of them has left is ended.
void Process::follow_topics(Now now) {
  static_cast<void>(clients_.take_topics_changed());
  std::set<std::string> runs = recorded_runs(book_);
  runs.merge(clients_.watched_runs());
  view_.watch_runs(std::move(runs), now);
  view_.watch_sensors(clients_.watched_sensors(now), now);
  view_.watch_robots(clients_.watches_robots(now), now);
}

void Process::record(Gateway& gateway, Now now) {
  recorder_.tick(now);
  if (recorder_.is_due(now) && !history_.is_writing()) write_history(gateway);
}

/// A history that cannot be written ends nothing: it is told once and noted, and what is lost is counted. A clock that
/// is ahead for a moment makes nothing old.
void Process::write_history(Gateway& gateway) {
  for (const auto& [node, entries] : recorder_.take_left_out()) {
    log_limited(left_out_lines_, read_clocks().mono, Level::warning, "history_left_out",
                node + ": " + std::to_string(entries) + " entries: it changes too often");
  }
  std::vector<HistoryEntry> batch = recorder_.take();
  const std::size_t size = batch.size();
  history_.add(std::move(batch), gateway.steady(), [this, size](const Status& written) {
    if (!written) recorder_.count_lost(size);
    if (!written && !history_lost_)
      log_limited(lost_lines_, read_clocks().mono, Level::error, "history_not_written", written.error().text());
    if (written && history_lost_) history_unread_.reset();  // it is another file, or there is room: to be seen anew
    history_lost_ = written ? std::nullopt : std::optional(written.error());
  });
}

/// What could not be written; and a note of it, which goes with it.
void Process::try_again(Gateway& gateway, Now now) {
  tried_ = now.mono;
  if (access_.unwritten()) {
    static_cast<void>(gateway.steady());
    static_cast<void>(gateway.retry());
  }
  // Also if there is nothing to write: whoever has mended it looks whether it is well.
  if (history_lost_ && !access_.unwritten() && !history_.is_writing()) write_history(gateway);
  service_.set_note(note_of(gateway));
}

/// There is room for one: the worst.
std::string Process::note_of(const Gateway& gateway) const {
  if (std::string full = full_note(gateway); !full.empty()) return full;
  const std::optional<Error>& why = history_lost_ ? history_lost_ : history_unread_;
  return why ? "the history cannot be kept or read: " + why->what + "; " + why->hint : "";
}

void Process::keep_house(Gateway& gateway, Now now) {
  house_kept_ = now.mono;
  warn_of_certificate(now);
  follow_topics(now);
  if (!refresh(gateway)) return;
  access_.tick(now, gateway.steady());
  view_.show_alarms(now);
  static_cast<void>(gateway.commit());
  if (db_.is_shared()) static_cast<void>(settle_unsure(access_, now.utc, gateway.steady() - kAbandoned));
}

/// Once a day, from 30 days before its end on.
void Process::warn_of_certificate(Now now) {
  if (certificate_ends_ - kRenewBefore > now.utc || (warned_ && now.mono - *warned_ < kWarnAgain)) return;
  warned_ = now.mono;
  log_event(Level::warning, "certificate_ends",
            "the certificate of people's connections ends at " + to_iso8601(certificate_ends_) +
                "; one that the gateway made is made anew at its next start (trb reload), another one is put into "
                "keys/gateway.crt and gateway.key");
}

void Process::end_unwritten(const Error& error) {
  log_event(Level::error, "not_written", error.text());
  unwritten_ = true;
}

}  // namespace trb::gateway
