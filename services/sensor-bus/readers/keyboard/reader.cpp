// A reader of tags that types. Grabbed: no other program gets its keys, so that no tag ends as a command in a terminal.
#include <fcntl.h>
#include <linux/input.h>
#include <sys/ioctl.h>

#include <array>
#include <cerrno>

#include "common/service/service.hpp"
#include "services/sensor-bus/readers/keyboard/tag_keys.hpp"
#include "services/sensor-bus/readers/registry.hpp"

namespace trb::sensor {
namespace {

constexpr Duration kRetry = std::chrono::seconds(1);

Result<Descriptor> open_keys(const std::string& devnode) {
  Descriptor keys(::open(devnode.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC));
  if (!keys) return system_error(devnode, errno);
  // ENOTTY: it is no keyboard of the kernel's, so no other program reads it as one.
  if (::ioctl(keys.get(), EVIOCGRAB, 1) != 0 && errno != ENOTTY) {
    return system_error(devnode + " cannot be kept from others", errno);
  }
  return keys;
}

/// The kernel's queue for a reader holds 64 events (a tag of ten digits with its Enter: 66); when it is full the kernel
/// throws all of it away, and says so by SYN_DROPPED. What comes behind that was really pressed.
void on_event(const input_event& event, TagKeys& typed, ReaderContext& context) {
  if (event.type == EV_SYN && event.code == SYN_DROPPED) {
    typed.lose();
    context.fail_all(fail(Errc::io_error, "keys were lost: they came faster than they were read",
                          "show the tag again, twice if need be"));
  }
  if (event.type != EV_KEY) return;
  if (const auto tag = typed.add(event.code, event.value)) context.send(0, {true, 0, *tag});
}

Status serve(ReaderContext& context, int keys) {
  TagKeys typed;
  for (;;) {
    const auto woken = context.wait(keys, std::nullopt);
    if (woken == ReaderContext::Woken::stopped) return Done{};
    if (woken == ReaderContext::Woken::asked) context.take_asked();  // the next tag is told anyway
    if (woken != ReaderContext::Woken::ready) continue;
    std::array<input_event, 64> events{};
    const ssize_t size = ::read(keys, events.data(), sizeof events);
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) continue;
    if (size < 0) return system_error(context.device().devnode, errno);
    if (size == 0) return fail(Errc::io_error, context.device().devnode + ": has hung up", "plug it in again");
    for (std::size_t i = 0; i < static_cast<std::size_t>(size) / sizeof(input_event); ++i) {
      on_event(events[i], typed, context);
    }
  }
}

}  // namespace

void run_keyboard(ReaderContext& context) {
  for (;;) {
    auto keys = [&] {
      const ReaderContext::Busy busy(context);
      return open_keys(context.device().devnode);
    }();
    const Status served = keys ? serve(context, keys->get()) : Status(keys.error());
    if (context.stopped()) return;
    if (!served) context.fail_all(served.error());
    const MonotonicTime again = now().mono + kRetry;
    while (context.wait(-1, again) == ReaderContext::Woken::asked) {
    }
    if (context.stopped()) return;
  }
}

}  // namespace trb::sensor
