#include "common/service/waiting.hpp"

#include <poll.h>

#include <algorithm>
#include <cstdio>

#include "common/base/disk_state.hpp"
#include "common/log/log.hpp"
#include "proto/bodies/bus.hpp"
#include "proto/value.hpp"

namespace trb {
namespace {

constexpr Duration kTryAgain = std::chrono::seconds(1);

Status try_open(const std::string& dir, const std::function<Status()>& open, Room room) {
  const auto disk = disk_state(dir);
  if (room == Room::needed && disk && !disk->read_only && disk->free_bytes < kLeastBytes) {
    return fail(Errc::io_error,
                "the disk of " + dir + " is full: " + std::to_string(disk->free_bytes / 1000) + " kB are free, " +
                    std::to_string(kLeastBytes / 1000) + " must be, and for new runs " +
                    std::to_string(kFullBytes / 1000),
                "make room: df -h " + dir + "; it goes on by itself");
  }
  return open();
}

bool may_pass(const Status& status) {
  return !status && status.error().code == Errc::io_error;
}

/// Also to standard error: on a full disk there is no log.
void report(const ServiceOptions& options, const Error& why) {
  log_event(Level::error, "waiting", why.text());
  std::fprintf(stderr, "trb-%s: waits: %s\n", options.name.c_str(), why.text().c_str());
}

int until(MonotonicTime due) {
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(due - now().mono).count() + 1;
  return static_cast<int>(std::clamp<decltype(left)>(left, 0, 1000));
}

/// The service as it waits, until `open` is done or has another error. A status: it was asked to end.
Result<std::optional<int>> wait(ServiceOptions options, const Error& why, Status& opened,
                                const std::function<Status()>& open, Room room) {
  options.waits = waits_of(why);
  const auto service = Service::open(options);
  if (!service) return service.error();
  report(options, why);
  WaitingCore core(why);
  (*service)->start(core);
  MonotonicTime again = now().mono + kTryAgain;
  while ((*service)->handle_ready()) {
    if (now().mono >= again) {
      opened = try_open(options.node_dir, open, room);
      if (!may_pass(opened)) return std::optional<int>();
      again = now().mono + kTryAgain;
    }
    const MonotonicTime due = std::min(again, (*service)->next_deadline().value_or(again));
    pollfd ready{(*service)->descriptor(), POLLIN, 0};
    (void)::poll(&ready, 1, until(due));
  }
  return std::optional((*service)->exit_status());
}

}  // namespace

void WaitingCore::on(const Inbound& message, Now, Outbox& out) {
  out.nack(message, fail(Errc::no_service, std::string(kWaitsNote) + why_.what, why_.hint));
}

std::string waits_of(const Error& why) {
  return cut_utf8(why.what + (why.hint.empty() ? "" : "; " + why.hint), kMaxWaits);
}

Result<std::optional<int>> wait_for_files(const ServiceOptions& options, const std::function<Status()>& open,
                                          Room room) {
  Status opened = try_open(options.node_dir, open, room);
  if (may_pass(opened)) {
    const auto waited = wait(options, Error(opened.error()), opened, open, room);
    if (!waited || *waited) return waited;
    if (opened) log_event(Level::info, "waited", "it goes on");
  }
  if (!opened) return opened.error();
  return std::optional<int>();
}

}  // namespace trb
