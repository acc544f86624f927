#include "services/router/io/router_shell.hpp"

#include <poll.h>

#include <csignal>

#include "common/base/files.hpp"
#include "services/router/io/lane_server.hpp"
#include "services/router/io/proof_log.hpp"
#include "services/router/io/resolver.hpp"
#include "services/router/io/seal_checker.hpp"

namespace trb::router {
namespace {

constexpr int kAgain = 75;  ///< the supervisor starts the router again at once

/// What may wait, in bytes, for one who hears (a service, a link, the tap), and in the whole node. One message more of
/// each is encrypted in libzmq's I/O thread, and the kernel has its buffers.
constexpr std::size_t kDestinationBytes = 8U << 20U;
constexpr std::size_t kNodeBytes = 64U << 20U;

}  // namespace

RouterShell::RouterShell(RouterConfig config, ShellOptions options)
    : core_(with_ports(std::move(config))),
      options_(std::move(options)),
      whole_(std::make_shared<ByteBudget>(kNodeBytes)),
      tap_budget_(new_budget()),
      proof_(std::make_unique<ProofLog>("log/proof", kUnsealed ? 0 : options_.proof_log_bytes)),
      checker_(std::make_unique<SealChecker>()),
      resolver_(std::make_unique<Resolver>()) {}

RouterShell::~RouterShell() = default;

RouterConfig RouterShell::with_ports(RouterConfig config) const {
  config.random = random_u64;
  config.has_room = [this](LinkId link, std::size_t bytes) { return link_has_room(link, bytes); };
  return config;
}

Status RouterShell::open() {
  // ZAP first: an inbox without it would let every key in.
  zap_ = std::make_unique<ZapServer>(context_, loop_, [this](BytesView domain, BytesView key) {
    if (domain == kBusDomain) return admit_to_bus(key);
    Effects effects;
    const bool good = domain == kLaneDomain ? core_.lanes().admit(key, effects)
                                            : core_.admission().admit(key, read_clocks(), effects);
    carry_out(effects);
    return good;
  });
  inbox_guard_.set_friends([this] { return sources_of_peers(); });
  lane_ = std::make_unique<LaneServer>(
      context_, loop_, core_.lanes(), core_.counters(), options_.link_keys, options_.pending_connections, whole_,
      LaneServer::Owner{[this](Effects& effects) { carry_out(effects); },
                        [this](const char* event, const std::string& text) {
                          log_limited(limit_, read_clocks().mono, Level::warning, event, text);
                        },
                        [this] { return sources_of_peers(); }});
  if (Status bus = open_bus(); !bus) return bus;
  return open_local_address();
}

Status RouterShell::open_bus() {
  if (!options_.bus.endpoint.empty()) return open_tcp_bus();
  if (Status made = make_private_dir("bus"); !made) return made;
  std::vector<std::string> names = core_.config().services;
  names.emplace_back(kProbe);
  for (const std::string& name : names) {
    if (name == "router") continue;
    auto socket = Socket::bus_server(context_, "ipc://bus/" + name + ".ipc");
    if (!socket) return socket.error();
    auto& bus = buses_[name] = std::make_unique<BusSocket>(BusSocket{std::move(*socket), name, {}});
    loop_.add_socket(
        bus->socket.handle(), [this, at = bus.get()] { drain_bus(*at); }, bus->socket.unseen());
  }
  auto tap = Socket::tap_server(context_, "ipc://bus/tap.ipc");
  if (!tap) return tap.error();
  tap_ = std::make_unique<Socket>(std::move(*tap));
  loop_.add_socket(
      tap_->handle(), [this] { drain_tap(); }, tap_->unseen());
  return Done{};
}

int RouterShell::run() {
  int status = 0;
  Signals signals(loop_, [this, &status](int signal) {
    status = signal == SIGHUP ? kAgain : 0;
    log_event(Level::info, "stopping", "signal " + std::to_string(signal));
    loop_.stop();
  });
  Effects effects;
  core_.start(read_clocks(), effects);
  carry_out(effects);
  notify_local_address();
  keys_watch_ = std::make_unique<KeysWatch>(loop_, "keys", [this] { read_key_folder(); });
  read_key_folder();
  loop_.add_fd(checker_->fd(), POLLIN, [this](short) { take_checked(); });
  loop_.add_timer([this] { return core_.next_deadline(); },
                  [this](Now now) {
                    Effects due;
                    core_.tick(now, due);
                    carry_out(due);
                  });
  while (loop_.turn()) closed_.clear();
  return status;
}

void RouterShell::carry_out(Effects& effects) {
  for (Effect& effect : effects.list) {
    std::visit(Overloaded{
                   [this](BusSend& send) {
                     count_sent(send.message.subtype);
                     const auto frame = own_frame(send.message);
                     if (!frame) return;
                     tap('=', *frame);
                     if (send_bus(send.to, to_frame(*frame)) == SendResult::full)
                       core_.counters().count("dropped.queue_full");
                   },
                   [this](LinkSend& send) { send_own(send); },
                   [this](SealDue& due) { send_seal(due.link); },
                   [this](CheckSeal& seal) { check_seal(std::move(seal)); },
                   [this](DeliverHeld& proven) { deliver_held(proven); },
                   [this](ReturnHeld& of) { return_held(of); },
                   [this](Dial& dial) { this->dial(dial); },
                   [this](DialLane& dial) { dial_lane(dial); },
                   [this](CloseLink& close) { close_link(close.link); },
                   [this](AcceptLink& accept) {
                     accepted_[accept.link] = {origin_.routing_id, origin_.user, origin_.pending, new_budget()};
                     inbox_guard_.linked(origin_.pending);
                   },
                   [this](RefuseCandidate& refuse) {
                     if (origin_.routing_id.empty()) return;
                     if (auto frame = own_frame(refuse.message)) {
                       stamp_link(frame->data(), refuse.link, 1, refuse.message.remaining_ms);
                       stamp_version(frame->data(), refuse.version);
                       inbox_->send_to(origin_.routing_id, to_frame(*frame));
                     }
                     inbox_guard_.leave(origin_.pending);
                   },
                   [this](SendBeacon& beacon) {
                     if (beacon_)
                       beacon_->send(seal_beacon(options_.beacon_key, core_.config().authority.id(), beacon.plain));
                   },
                   [](StorePeers& store) {
                     if (Status kept = write_file("state/peers", store.text, 0600); !kept)
                       log_event(Level::warning, "state", kept.error().text());
                   },
                   [this](StoreNews& store) { store_news(store); },
                   [this](StoreCertificate& store) { store_certificate(store); },
                   [this](StoreBoot& store) { store_boot(store); },
                   [this](StoreUtc& store) { store_utc(store); },
                   [this](Log& line) {
                     log_limited(limit_, read_clocks().mono, static_cast<Level>(line.level), line.event, line.text);
                   },
               },
               effect);
  }
  for (const std::string& name : effects.counts) core_.counters().count(name);
  report_unsent();
  end_lost_links();
}

void RouterShell::report_unsent() {
  for (const auto& [message, reason] : std::exchange(unsent_, {})) {
    Effects effects;
    core_.forwarding().on_own_unsent(message, reason, effects);
    carry_out(effects);
  }
}

void RouterShell::end_lost_links() {
  // An accepted link whose connection is gone shows it at the next send.
  while (!lost_links_.empty()) {
    const LinkId link = lost_links_.back();
    lost_links_.pop_back();
    Effects effects;
    core_.links().on_ended(link, LinkEnd::disconnected, read_clocks(), effects);
    carry_out(effects);
  }
}

std::shared_ptr<ByteBudget> RouterShell::new_budget() const {
  return std::make_shared<ByteBudget>(kDestinationBytes, whole_);
}

/// Nothing if its hearer would have to refuse it: the core makes none such, and a link must not end by one.
std::optional<Bytes> RouterShell::own_frame(const Message& message) {
  Bytes frame = encode_frame(message);
  const auto readable = decode_frame(frame);
  if (readable) return frame;
  core_.counters().count("dropped." + std::string(errc_name(readable.error().code)));
  log_limited(limit_, read_clocks().mono, Level::error, "not_sent",
              message.subtype + " for '" + message.target + "': " + readable.error().text());
  return std::nullopt;
}

void RouterShell::send_own(LinkSend& send) {
  count_sent(send.message.subtype);
  const auto frame = own_frame(send.message);
  if (!frame) return;
  tap('>', *frame);
  const SendResult result = send_link(send.link, to_frame(*frame));
  if (result == SendResult::sent) return;
  if (result == SendResult::unroutable) lost_links_.push_back(send.link);
  unsent_.emplace_back(std::move(send.message), why_unsent(result));
}

void RouterShell::tap(char direction, BytesView frame) {
  if (tap_listeners_ == 0) return;
  Frame copy = to_frame(frame);
  const SendResult result = send_within(tap_budget_, copy, [&](Frame&& one) {
    tap_->send(to_frame(std::string(1, direction)), true);
    return tap_->send(std::move(one));
  });
  if (result != SendResult::sent) core_.counters().count("dropped.tap_full");
}

void RouterShell::drain_tap() {
  Frame frame;
  while (tap_->receive(frame)) {
    const BytesView word = view_of(frame);
    if (word.empty()) continue;
    if (word[0] == 1) {
      ++tap_listeners_;
    } else if (tap_listeners_ > 0) {
      --tap_listeners_;
    }
  }
}

void RouterShell::count_sent(std::string_view subtype) {
  auto at = sent_names_.find(subtype);
  if (at == sent_names_.end()) {
    if (sent_names_.size() >= 500) return;
    at = sent_names_.emplace(subtype, "sent." + std::string(subtype)).first;
  }
  core_.counters().count(at->second);
}

void RouterShell::on_beacon_datagram(BytesView datagram) {
  auto plain = open_beacon(options_.beacon_key, core_.config().authority.id(), datagram);
  Effects effects;
  if (!plain) {
    core_.beacons().refuse(errc_name(plain.error().code), plain.error().what, read_clocks(), effects);
  } else {
    core_.beacons().on_beacon(*plain, read_clocks(), effects);
  }
  carry_out(effects);
}

}  // namespace trb::router
