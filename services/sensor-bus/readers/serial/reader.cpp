// A serial line: NMEA, or a line protocol of a rule's.
#include <fcntl.h>
#include <sys/ioctl.h>
#include <termios.h>

#include <array>
#include <cerrno>
#include <map>

#include "common/service/service.hpp"
#include "services/sensor-bus/readers/registry.hpp"
#include "services/sensor-bus/readers/serial/lines.hpp"
#include "services/sensor-bus/readers/serial/nmea.hpp"

namespace trb::sensor {
namespace {

constexpr Duration kRetry = std::chrono::seconds(1);
constexpr Duration kLeastGap = std::chrono::milliseconds(20);
constexpr int kBadLines = 3;  // in a row; one is noise

speed_t speed_of(std::uint32_t baud) {
  static const std::map<std::uint32_t, speed_t> kSpeeds = {{1200, B1200},     {2400, B2400},     {4800, B4800},
                                                           {9600, B9600},     {19200, B19200},   {38400, B38400},
                                                           {57600, B57600},   {115200, B115200}, {230400, B230400},
                                                           {460800, B460800}, {921600, B921600}, {1'000'000, B1000000}};
  const auto at = kSpeeds.find(baud);
  return at == kSpeeds.end() ? B9600 : at->second;
}

Result<Descriptor> open_line(const std::string& devnode, std::uint32_t baud) {
  Descriptor line(::open(devnode.c_str(), O_RDONLY | O_NOCTTY | O_NONBLOCK | O_CLOEXEC));
  if (!line) return system_error(devnode, errno);
  termios settings{};
  if (::tcgetattr(line.get(), &settings) != 0) return system_error(devnode + " is no serial line", errno);
  ::cfmakeraw(&settings);
  settings.c_cflag |= CLOCAL | CREAD;
  settings.c_cflag &= ~static_cast<tcflag_t>(CRTSCTS);
  ::cfsetispeed(&settings, speed_of(baud));
  ::cfsetospeed(&settings, speed_of(baud));
  if (::tcsetattr(line.get(), TCSANOW, &settings) != 0) return system_error(devnode, errno);
  ::ioctl(line.get(), TIOCEXCL);
  return line;
}

class Serial {
 public:
  explicit Serial(ReaderContext& context) : context_(context), last_sent_(context.channels().size()) {
    for (const FoundChannel& channel : context.channels()) skip_first_ = skip_first_ || channel.how->field.has_value();
  }

  /// Until the line is gone or all is over. The error, if it is gone.
  Status serve(int line) {
    lines_ = LineReader();
    first_ = true;
    for (;;) {
      const auto woken = context_.wait(line, std::nullopt);
      if (woken == ReaderContext::Woken::stopped) return Done{};
      if (woken == ReaderContext::Woken::asked) asked_.merge(context_.take_asked());
      if (woken != ReaderContext::Woken::ready) continue;
      if (Status read = read_some(line); !read) return read;
    }
  }

 private:
  Status read_some(int line) {
    std::array<char, 4096> bytes{};
    const ssize_t size = ::read(line, bytes.data(), bytes.size());
    if (size < 0 && (errno == EAGAIN || errno == EINTR)) return Done{};
    if (size < 0) return system_error(context_.device().devnode, errno);
    if (size == 0) return fail(Errc::io_error, context_.device().devnode + ": has hung up", "plug it in again");
    lines_.add({bytes.data(), static_cast<std::size_t>(size)}, [this](std::string_view each) { on_line(each); });
    if (lines_.take_too_long()) {
      context_.fail_all(fail(Errc::too_large,
                             "a line is longer than " + std::to_string(LineReader::kMaxLine) + " bytes",
                             "look at the rule's \"baud\""));
    }
    return Done{};
  }

  void on_line(std::string_view line) {
    // What is heard first may be the end of a line; a pattern would not fit it, a checksum be wrong, a field be
    // another.
    if (std::exchange(first_, false) && skip_first_) return;
    const auto fault = context_.rule().by == ReadBy::nmea ? on_sentence(line) : on_values(line);
    bad_ = fault ? bad_ + 1 : 0;
    if (bad_ < kBadLines) return;
    bad_ = 0;
    const MonotonicTime at = now().mono;
    if (at - failed_at_ < kRetry) return;
    failed_at_ = at;
    context_.fail_all(*fault);
  }

  std::optional<Error> on_sentence(std::string_view line) {
    const auto fix = parse_nmea(line);
    if (!fix) return fix.error();
    for (std::size_t i = 0; i < last_sent_.size(); ++i) {
      const NmeaValue which = context_.channels()[i].how->nmea;
      const auto value = fix->value(which);
      if (value) send_if_due(i, *value);
      if (!value && fix->none && which != NmeaValue::satellites && is_due(i)) {
        context_.fail_one(i, fail(Errc::missing, "no fix", "let its antenna see the sky"));
      }
    }
    return std::nullopt;
  }

  std::optional<Error> on_values(std::string_view line) {
    std::optional<Error> fault;
    bool spoke = false;
    for (std::size_t i = 0; i < last_sent_.size(); ++i) {
      const auto value = parse_line(context_.rule(), *context_.channels()[i].how, line);
      if (!value) fault = value.error();
      if (!value || !*value) continue;
      spoke = true;
      send_if_due(i, **value);
    }
    if (spoke) return std::nullopt;
    return fault ? fault : fail(Errc::malformed, "no line is as the rule says", "look at its \"pattern\" and \"baud\"");
  }

  void send_if_due(std::size_t channel, const Measured& value) {
    if (is_due(channel)) context_.send(channel, value);
  }

  /// Not more often than the rule says, but at once if somebody asks.
  bool is_due(std::size_t channel) {
    const MonotonicTime at = now().mono;
    const double every = context_.channels()[channel].how->every_s;
    const Duration gap = every > 0 ? std::chrono::duration_cast<Duration>(seconds(0.9 * every)) : kLeastGap;
    if (at - last_sent_[channel] < gap && asked_.erase(channel) == 0) return false;
    asked_.erase(channel);
    last_sent_[channel] = at;
    return true;
  }

  ReaderContext& context_;
  LineReader lines_;
  std::vector<MonotonicTime> last_sent_;
  std::set<std::size_t> asked_;
  MonotonicTime failed_at_;
  int bad_ = 0;
  bool skip_first_ = false;
  bool first_ = true;
};

void run_serial(ReaderContext& context) {
  Serial serial(context);
  for (;;) {
    auto line = [&] {
      const ReaderContext::Busy busy(context);
      return open_line(context.device().devnode, context.rule().baud);
    }();
    Status served = line ? serial.serve(line->get()) : Status(line.error());
    if (line) ::ioctl(line->get(), TIOCNXCL);
    if (context.stopped()) return;
    if (!served) context.fail_all(served.error());
    const MonotonicTime again = now().mono + kRetry;
    while (context.wait(-1, again) == ReaderContext::Woken::asked) {
    }
    if (context.stopped()) return;
  }
}

}  // namespace

void run_nmea(ReaderContext& context) {
  run_serial(context);
}

void run_line(ReaderContext& context) {
  run_serial(context);
}

}  // namespace trb::sensor
