#include "services/router/io/router_shell.hpp"

#include <algorithm>
#include <csignal>
#include <filesystem>

#include "common/base/disk_state.hpp"
#include "common/security/keys.hpp"
#include "common/security/stored_updates.hpp"
#include "common/transport/signals.hpp"
#include "services/router/core/metrics_text.hpp"
#include "services/router/io/own_frame.hpp"

namespace trb::router {
namespace {

constexpr int kStartAgain = 75;  ///< the supervisor starts the router again at once

}  // namespace

RouterShell::RouterShell(RouterConfig config, const ShellOptions& options)
    : core_(with_ports(std::move(config))),
      shell_(core_, [this](Effects& effects) { carry_out(effects); }),
      tap_(shell_),
      sent_(core_.counters()),
      zap_(shell_.zmq(), shell_.loop(), [this](BytesView domain, BytesView key) { return admit(domain, key); }),
      bus_(shell_, tap_, forwarder_, sent_, options.bus),
      inbox_(shell_, forwarder_, options.link_keys, options.pending_connections),
      dialled_(shell_, forwarder_, options.link_keys),
      links_(shell_, tap_, inbox_, dialled_),
      lanes_(shell_, forwarder_, options),
      held_(shell_, bus_),
      proof_(shell_, kUnsealed ? 0 : options.proof_log_bytes),
      forwarder_(shell_, {tap_, bus_, links_, lanes_, held_, proof_}),
      seals_(shell_),
      beacons_(shell_, options.beacon_key, options.beacon_port),
      address_(shell_, inbox_, lanes_, beacons_, options),
      files_(shell_, beacons_, {options.link_keys.public_key, options.link_keys.secret_key}),
      metrics_at_(options.metrics),
      metrics_(shell_.loop(), [this] { return metrics(); }) {}

RouterConfig RouterShell::with_ports(RouterConfig config) const {
  config.random = random_u64;
  config.machine_note = [this, dir = std::filesystem::current_path().string()] {
    const auto disk = disk_state(dir);
    const std::string room = disk ? note_of_room(*disk, dir) : "";
    return room + (room.empty() || no_metrics_.empty() ? "" : "; ") + no_metrics_;
  };
  config.has_room = [this](LinkId link, std::size_t bytes) { return links_.has_room(link, bytes); };
  return config;
}

Status RouterShell::open() {
  if (Status bus = bus_.open(); !bus) return bus;
  if (Status address = address_.open(); !address) return address;
  // To stop the robot there must be a router, whether or not it is watched: last, so that it takes no port of the
  // router's.
  if (const Status metrics = metrics_at_ ? metrics_.open(*metrics_at_) : Done{}; !metrics) {
    log_event(Level::error, "no_metrics", metrics.error().text());
    no_metrics_ = "no metrics, and Prometheus takes the node for gone: " + metrics.error().text();
  }
  return Done{};
}

std::string RouterShell::metrics() {
  const Now now = read_clocks();
  const Answers& answers = core_.answers();
  NodeMetrics is;
  is.services = answers.service_table(now);
  for (RouteTable page = answers.route_table(now); !take_page(page, is);) {
    page = answers.route_table(now, page.routes.back().id);
  }
  if (const auto own = decode<Certificate>(is.own.certificate.payload.bytes)) {
    is.certificate_ends_s = own->not_after / 1'000'000'000;
  }
  if (const auto disk = disk_state(".")) is.disk_free_bytes = disk->free_bytes;
  is.counters = core_.counters().table(core_.config().id, "router");
  return metrics_text(is);
}

bool RouterShell::admit(BytesView domain, BytesView key) {
  if (domain == kBusDomain) return bus_.admit(key);
  Effects effects;
  const bool good =
      domain == kLaneDomain ? core_.lanes().admit(key, effects) : core_.admission().admit(key, read_clocks(), effects);
  carry_out(effects);
  return good;
}

/// A start reads what has been mended meanwhile.
void RouterShell::watch_lost_updates(int& status) {
  if (!core_.config().updates_lost) return;
  shell_.loop().add_timer([this] { return std::optional(look_again_); },
                          [this, &status](Now now) {
                            look_again_ = now.mono + std::chrono::seconds(1);
                            if (!read_stored_updates(".", core_.config().authority)) return;
                            log_event(Level::info, "revocations_known", "it starts again, and reads them");
                            status = kStartAgain;
                            shell_.loop().stop();
                          });
}

int RouterShell::run() {
  Loop& loop = shell_.loop();
  int status = 0;
  Signals signals(loop, [&](int signal) {
    status = signal == SIGHUP ? kStartAgain : 0;
    log_event(Level::info, "stopping", "signal " + std::to_string(signal));
    loop.stop();
  });
  Effects effects;
  core_.start(read_clocks(), effects);
  carry_out(effects);
  address_.notify();
  files_.watch_keys();
  seals_.watch();
  watch_lost_updates(status);
  loop.add_timer([this] { return core_.next_deadline(); },
                 [this](Now now) {
                   Effects due;
                   core_.tick(now, due);
                   carry_out(due);
                 });
  loop.add_timer([this] { return std::optional(round_.next()); }, [this](Now now) { look(now); });
  while (loop.turn()) {
    dialled_.free_closed();
    lanes_.free_closed();
  }
  return status;
}

void RouterShell::carry_out(Effects& effects) {
  for (Effect& effect : effects.list) {
    std::visit([this](auto& one) { carry_out(one); }, effect);
  }
  for (const std::string& name : effects.counts) core_.counters().count(name);
  report_unsent();
  forwarder_.report_lost_links();
}

void RouterShell::carry_out(BusSend& send) {
  sent_.count(send.message.subtype);
  const auto frame = encode_own(shell_, send.message);
  if (!frame) return;
  tap_.show('=', *frame);
  // What a relay has brought of a peer is that peer's.
  if (bus_.send_of(send.message.source, send.to, to_frame(*frame)) == SendResult::full)
    shell_.count("dropped.queue_full");
}

void RouterShell::carry_out(LinkSend& send) {
  sent_.count(send.message.subtype);
  if (const auto frame = encode_own(shell_, send.message))
    links_.send_own(send.link, std::move(send.message), *frame, send.peer);
}

void RouterShell::carry_out(Dial& dial) {
  // It ends like a dial that failed, and is tried again.
  if (!dialled_.dial(dial, address_.scope())) links_.lose(dial.link);
}

void RouterShell::carry_out(CloseLink& close) {
  inbox_.close_link(close.link);
  lanes_.close_link(close.link);
  core_.seals().forget(close.link);
  proof_.close_link(close.link);
  held_.close_link(close.link);
  dialled_.close(close.link);
}

void RouterShell::look(Now now) {
  const LookPart part = round_.step(
      now.mono, std::max({inbox_.connections(), dialled_.connections(), lanes_.connections(), bus_.connections()}));
  inbox_.look(part);
  dialled_.look(part);
  lanes_.look(part);
  bus_.look(part);
  memory_.look(now.mono, core_.counters().value("cut.incomplete"));
}

void RouterShell::report_unsent() {
  for (const auto& [message, reason] : links_.take_unsent()) {
    Effects effects;
    core_.forwarding().on_own_unsent(message, reason, read_clocks(), effects);
    carry_out(effects);
  }
}

}  // namespace trb::router
