// Files below /sys, read again and again. Each is opened anew: a descriptor would keep what a driver once said.
#include <fcntl.h>

#include <array>
#include <cerrno>

#include "common/service/service.hpp"
#include "services/sensor-bus/readers/attributes/w1_slave.hpp"
#include "services/sensor-bus/readers/measured.hpp"
#include "services/sensor-bus/readers/registry.hpp"

namespace trb::sensor {
namespace {

constexpr std::size_t kMaxAttribute = 4096;  // a page: the kernel gives no more

Result<std::string> read_once(const std::string& path) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NOCTTY));
  if (!file) return system_error(path, errno);
  std::array<char, kMaxAttribute> bytes{};
  const ssize_t size = ::read(file.get(), bytes.data(), bytes.size());
  if (size < 0) return system_error(path, errno);
  return std::string(bytes.data(), static_cast<std::size_t>(size));
}

/// What has no end of line may be half of it: it counts if it is read twice.
Result<std::string> read_attribute(const std::string& path) {
  auto text = read_once(path);
  if (!text || text->ends_with('\n')) return text;
  auto again = read_once(path);
  if (!again || *again == *text || again->ends_with('\n')) return again;
  return fail(Errc::malformed, path + ": is only half there", "it is read again");
}

class Attributes {
 public:
  explicit Attributes(ReaderContext& context) : context_(context), folder_(context.device().syspath + "/") {}

  void read(std::size_t channel) {
    auto value = [&] {
      const ReaderContext::Busy busy(context_);
      return value_of(context_.channels()[channel]);
    }();
    if (value)
      context_.send(channel, {false, *value, {}});
    else
      context_.fail_one(channel, value.error());
  }

 private:
  Result<double> number(const std::string& name) {
    const auto text = read_attribute(folder_ + name);
    if (!text) return text.error();
    auto value = parse_finite(*text);
    if (!value) return fail(value.error().code, name + ": " + value.error().what, value.error().hint);
    return value;
  }

  /// Not all channels have an offset, and some no scale.
  Result<double> number_or(const std::string& name, double otherwise) {
    return context_.device().attribute_names.contains(name) ? number(name) : Result<double>(otherwise);
  }

  Result<double> raw(const std::string& channel) {
    auto value = number(channel + "_raw");
    auto offset = number_or(channel + "_offset", 0);
    auto scale = number_or(channel + "_scale", 1);
    for (const auto* part : {&value, &offset, &scale}) {
      if (!*part) return part->error();
    }
    return (*value + *offset) * *scale;
  }

  /// `temperature` has no checksum, `w1_slave` does; newer drivers tell an error instead of a wrong value by both.
  Result<double> thermometer() {
    if (!context_.device().attribute_names.contains("w1_slave")) return number("temperature");
    const auto text = read_once(folder_ + "w1_slave");
    if (!text) return text.error();
    return parse_w1_slave(*text);
  }

  Result<double> value_of(const FoundChannel& channel) {
    if (context_.rule().by == ReadBy::w1) return thermometer();
    return channel.is_raw ? raw(channel.attribute) : number(channel.attribute);
  }

  ReaderContext& context_;
  std::string folder_;
};

void read_files(ReaderContext& context) {
  Attributes attributes(context);
  const auto& channels = context.channels();
  std::vector<MonotonicTime> due(channels.size(), now().mono);
  for (;;) {
    const auto asked = context.take_asked();
    for (std::size_t i = 0; i < channels.size() && !context.stopped(); ++i) {
      const MonotonicTime at = now().mono;
      if (due[i] > at && !asked.contains(i)) continue;
      attributes.read(i);
      if (due[i] <= at) due[i] = std::max(due[i] + seconds(channels[i].how->every_s), at);
    }
    const MonotonicTime next = *std::min_element(due.begin(), due.end());
    if (context.wait(-1, next) == ReaderContext::Woken::stopped) return;
  }
}

}  // namespace

void run_attributes(ReaderContext& context) {
  read_files(context);
}

void run_w1(ReaderContext& context) {
  read_files(context);
}

}  // namespace trb::sensor
