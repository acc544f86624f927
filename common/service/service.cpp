#include "common/service/service.hpp"

#include <unistd.h>
#include <csignal>
#include <filesystem>
#include <utility>

#include "common/actor/counter_table.hpp"
#include "common/actor/journal_queue.hpp"
#include "common/base/files.hpp"
#include "common/log/log.hpp"
#include "common/security/keys.hpp"
#include "common/service/bus_link.hpp"
#include "common/service/version.hpp"
#include "common/transport/loop.hpp"
#include "common/transport/signals.hpp"
#include "proto/deadline.hpp"

namespace trb {
namespace {

constexpr int kAgain = 75;        ///< EX_TEMPFAIL: the supervisor starts the service again at once
constexpr int kJournalLost = 74;  ///< EX_IOERR
constexpr int kRefused = 73;      ///< EX_CANTCREAT: another process runs this service already
constexpr int kBatch = 256;
constexpr Duration kLongestDrain = std::chrono::milliseconds(50);  ///< then the link's own deadlines have their turn
constexpr std::size_t kMostRefused = 64;
constexpr std::uint64_t kRefusedHere = 1;  ///< a Nack answers something; cores do not learn ids
constexpr Duration kIdleCheck = std::chrono::milliseconds(200);

Level to_level(LogLevel level) {
  return static_cast<Level>(level);
}

class ServiceShell final : public Service {
 public:
  ServiceShell(ServiceOptions options, const BusAddress& bus)
      : options_(std::move(options)),
        instance_(random_u64()),
        link_(context_, bus,
              ServiceHello{options_.name, options_.subtypes, instance_, static_cast<std::uint32_t>(::getpid()),
                           kVersion, options_.hears, options_.waits}) {}

  [[nodiscard]] std::uint64_t instance() const override { return instance_; }
  void on_journal(std::function<Status(const std::vector<Journal>&)> commit) override { commit_ = std::move(commit); }
  void after_sends(std::function<void()> carry_out) override { after_sends_ = std::move(carry_out); }
  void before_end(Effect begin, std::function<bool()> done, Duration longest) override {
    last_work_ = LastWork{std::move(begin), std::move(done), longest};
  }
  void watch(int fd, short events, std::function<void(short)> ready) override {
    loop_.add_fd(fd, events, std::move(ready));
  }
  void unwatch(int fd) override { loop_.remove_fd(fd); }
  void timer(std::function<std::optional<MonotonicTime>()> next, std::function<void(Now)> tick) override {
    loop_.add_timer(std::move(next), std::move(tick));
  }

  /// Nothing once a commit has failed: the core believes what is not on disk.
  void step(const Effect& effect) override {
    if (has_lost_journal_) return;
    outbox_.clear();
    effect(read_clocks(), outbox_);
    Outbox out = std::move(outbox_);
    outbox_ = Outbox{};
    carry_out(out);
  }

  void set_note(std::string note) override { link_.set_note(std::move(note)); }
  [[nodiscard]] bool has_room() const override { return link_.has_room(); }
  [[nodiscard]] MonotonicTime router_heard() const override { return link_.last_heard(); }

  int run(Core& core, std::function<bool()> idle) override {
    start(core, std::move(idle));
    loop_.run();
    finish();
    return exit_;
  }

  void start(Core& core, std::function<bool()> idle) override {
    core_ = &core;
    idle_ = std::move(idle);
    signals_.emplace(loop_, [this](int signal) { on_signal(signal); });
    loop_.add_socket(
        link_.handle(), [this] { drain(); }, link_.unseen());
    loop_.add_timer([this] { return link_.next_deadline(); }, [this](Now now) { tick_link(now); });
    loop_.add_timer([this] { return core_->next_deadline(); },
                    [this](Now) { step([this](Now now, Outbox& out) { core_->tick(now, out); }); });
    loop_.add_timer([this] { return refused_.empty() ? std::nullopt : std::optional(MonotonicTime{0}); },
                    [this](Now) { deliver_refused(); });
    loop_.add_timer([this] { return journal_.due(); }, [this](Now) { commit(journal_.take()); });
    loop_.add_timer([this] { return reload_check_; }, [this](Now now) { try_reload(now); });
    loop_.add_timer([this] { return ends(); }, [this](Now) { loop_.stop(); });
  }

  [[nodiscard]] int descriptor() const override { return loop_.descriptor(); }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() override { return loop_.next_deadline(); }
  bool handle_ready() override {
    const bool goes_on = loop_.handle_ready();
    if (!goes_on) finish();
    return goes_on;
  }
  [[nodiscard]] int exit_status() const override { return exit_; }

 private:
  void finish() {
    if (journal_.due() && !has_lost_journal_) commit(journal_.take());
    loop_.remove_socket(link_.handle());
    signals_.reset();
  }

  void on_signal(int signal) {
    if (signal == SIGHUP) {
      if (!ends_by_) reload_check_ = MonotonicTime{0};
      return;
    }
    log_event(Level::info, "stopping", "signal " + std::to_string(signal));
    end();
  }

  /// Told twice is told once: systemd signals the service, and so does its supervisor.
  void end() {
    if (ends_by_) return;
    reload_check_.reset();
    if (!last_work_) return loop_.stop();
    ends_by_ = read_clocks().mono + last_work_->longest;
    step(last_work_->begin);
  }

  [[nodiscard]] std::optional<MonotonicTime> ends() const {
    return ends_by_ && last_work_->done() ? std::optional(MonotonicTime{0}) : ends_by_;
  }

  void try_reload(Now now) {
    if (has_lost_journal_) return;
    if (idle_ && !idle_()) {
      reload_check_ = now.mono + kIdleCheck;
      return;
    }
    log_event(Level::info, "reloading", "idle: ends, to be started again with the new files");
    exit_ = kAgain;
    end();
  }

  void tick_link(Now now) {
    if (has_lost_journal_) return;
    link_.tick(now);
    if (const std::size_t lost = link_.take_lost(); lost != 0) counters_.count("dropped.no_router", lost);
    if (const std::string problem = link_.take_dial_problem(); !problem.empty()) {
      log_event(Level::warning, "not_dialled", problem + "; tried again in 3 s");
    }
    if (link_.refusal().empty() || ends_by_) return;
    log_event(Level::error, "refused_by_router", link_.refusal());
    exit_ = kRefused;
    end();
  }

  void drain() {
    Now now = read_clocks();
    const MonotonicTime end = now.mono + kLongestDrain;
    for (int i = 0; i < kBatch && now.mono < end && !has_lost_journal_; ++i, now = read_clocks()) {
      std::optional<Message> message = link_.receive(now);
      if (link_.newly_welcomed) {
        link_.newly_welcomed = false;
        welcomed();
      }
      if (message) {
        deliver(*message);
      } else if (!*link_.unseen()) {
        return;
      }
    }
  }

  void welcomed() {
    const ServiceWelcome& welcome = *link_.welcome();
    node_ = welcome.node;
    log_event(Level::info, "welcomed", "node " + welcome.node + ", slot " + std::to_string(welcome.slot));
    const Role role = welcome.role == name_of(Role::cloud) ? Role::cloud : Role::robot;
    step([&](Now now, Outbox& out) { core_->on_welcome({welcome.node, role, welcome.boot}, now, out); });
  }

  void deliver(Message& message) {
    auto body = decode_body(message.subtype, message.data);
    const std::uint32_t remaining =
        remaining_after(loop_.waited(read_clocks().mono), message.type, message.subtype, message.remaining_ms);
    Inbound inbound{message.type, std::move(message.source),  std::move(message.target),
                    message.id,   message.reply_to,           message.flags,
                    remaining,    Opaque{message.subtype, {}}};
    if (!body) {
      step([&](Now, Outbox& out) {
        out.count("refused.malformed_body");
        out.log(LogLevel::warning, "malformed_body", "from " + inbound.source + ": " + body.error().text());
        out.nack(inbound, body.error());
      });
      return;
    }
    inbound.body = std::move(*body);
    if (holds_alternative<ServiceCountersRequest>(inbound.body) ||
        holds_alternative<AdapterCountersRequest>(inbound.body)) {
      step([&](Now, Outbox& out) { out.reply(inbound, counters_.table(node_, options_.name)); });
      return;
    }
    step([&](Now now, Outbox& out) { core_->on(inbound, now, out); });
  }

  void carry_out(Outbox& out) {
    if (!out.journal.empty() && !keep(std::move(out.journal))) return;
    for (const Send& send : out.sends) {
      const auto sent = link_.send(send);
      if (!sent) {
        not_sent(send, sent.error());
      } else if (*sent == 0) {
        counters_.count("dropped.no_router");
      }
    }
    if (after_sends_) after_sends_();
    for (const std::string& name : out.counts) counters_.count(name);
    for (const Log& line : out.logs) {
      log_limited(limit_, read_clocks().mono, to_level(line.level), line.event, line.text);
    }
  }

  /// No receiver could read it, or the router does not take it. If another node waits for it as an answer, that node
  /// gets the Nack; else the core itself does.
  void not_sent(const Send& send, const Error& why) {
    const std::string subtype(subtype_of(send.body));
    counters_.count("dropped." + std::string(errc_name(why.code)));
    log_limited(limit_, read_clocks().mono, Level::error, "not_sent",
                subtype + " for '" + send.target + "': " + why.text());
    Nack nack{std::string(errc_name(why.code)), subtype, send.target, why.what, why.hint};
    if (send.reply_to != 0) {
      (void)link_.send(Send{.target = send.target, .reply_to = send.reply_to, .body = std::move(nack)});
    } else if (refused_.size() < kMostRefused) {
      refused_.push_back(std::move(nack));
    }
  }

  /// In a turn of their own: a core that sends the same again at once must not block the loop.
  void deliver_refused() {
    for (Nack& nack : std::exchange(refused_, {})) {
      const Inbound inbound{MessageType::information, node_,          node_, 0, kRefusedHere, 0,
                            kDefaultRemainingMs,      std::move(nack)};
      step([&](Now now, Outbox& out) { core_->on(inbound, now, out); });
    }
  }

  /// False: what has to be on disk before the step's messages is not.
  bool keep(std::vector<Journal> records) {
    return !journal_.add(std::move(records), read_clocks().mono) || commit(journal_.take());
  }

  bool commit(const std::vector<Journal>& records) {
    const Status done = commit_ ? commit_(records) : Status(fail(Errc::io_error, "no journal"));
    if (done) return true;
    log_event(Level::error, "journal_failed", done.error().text() + " (the process ends: nothing may rest on it)");
    has_lost_journal_ = true;
    exit_ = kJournalLost;
    loop_.stop();
    return false;
  }

  ServiceOptions options_;
  std::uint64_t instance_;
  Context context_;
  Loop loop_;
  std::optional<Signals> signals_;  ///< while it runs
  BusLink link_;
  std::string node_;
  Core* core_ = nullptr;
  Outbox outbox_;
  std::function<Status(const std::vector<Journal>&)> commit_;
  JournalQueue journal_;
  std::function<void()> after_sends_;
  std::function<bool()> idle_;
  std::optional<MonotonicTime> reload_check_;
  struct LastWork {
    Effect begin;
    std::function<bool()> done;
    Duration longest;
  };
  std::optional<LastWork> last_work_;
  std::optional<MonotonicTime> ends_by_;  ///< set: it was told to end, and does its last work
  CounterTable counters_;
  std::vector<Nack> refused_;  ///< sent by the core, and lost in this process
  RateLimit limit_{20, std::chrono::seconds(10)};
  int exit_ = 0;
  bool has_lost_journal_ = false;  ///< nothing is received, told or sent any more
};

}  // namespace

Now now() {
  return read_clocks();
}

Result<std::unique_ptr<Service>> Service::open(ServiceOptions options) {
  init_crypto();
  block_signals();
  if (::chdir(options.node_dir.c_str()) != 0) {
    return fail(Errc::missing, options.node_dir + ": no such folder", "name a node's folder");
  }
  for (const char* folder : {"log", "state"}) {
    if (Status made = make_private_dir(folder); !made) return made.error();
  }
  open_log(options.name, options.own_log ? "log/" + options.name + ".log" : "");
  auto bus = bus_address(options.name);
  if (!bus) return bus.error();
  std::unique_ptr<Service> service = std::make_unique<ServiceShell>(std::move(options), *bus);
  return service;
}

}  // namespace trb
