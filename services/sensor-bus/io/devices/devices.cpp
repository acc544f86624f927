#include "services/sensor-bus/io/devices/devices.hpp"

#include <poll.h>

#include <algorithm>
#include <thread>

namespace trb::sensor {
namespace {

/// How soon a hanging reader is noticed, beyond its time-out.
constexpr Duration kLook = std::chrono::milliseconds(250);
constexpr Duration kLookForUdevd = std::chrono::seconds(2);
constexpr Duration kLastWait = std::chrono::milliseconds(500);

void log(Level level, std::string_view event, const std::string& text) {
  log_event(level, event, cut_utf8(text, 400));
}

std::string seconds_text(double s) {
  std::string out = std::to_string(s);
  out.erase(out.find_last_not_of('0') + 1);
  if (out.ends_with('.')) out.pop_back();
  return out + " s";
}

}  // namespace

Result<std::unique_ptr<Devices>> Devices::open(Service& service, DeviceListener& listener,
                                               std::vector<SensorRule> rules) {
  auto pool = ReaderPool::make();
  if (!pool) return pool.error();
  std::unique_ptr<Devices> out(new Devices(service, listener, std::move(rules), std::move(*pool)));
  if (Status opened = out->open_monitor(); !opened) return opened.error();
  return out;
}

Devices::Devices(Service& service, DeviceListener& listener, std::vector<SensorRule> rules,
                 std::shared_ptr<ReaderPool> pool)
    : service_(service), listener_(listener), recognition_(std::move(rules)), reader_pool_(std::move(pool)) {
  service_.watch(reader_pool_->ready_fd(), POLLIN, [this](short) { on_posts(); });
  service_.timer([this] { return std::min(next_look_, next_udevd_look_); }, [this](Now at) { look(at); });
}

Devices::~Devices() {
  service_.unwatch(reader_pool_->ready_fd());
  if (monitor_) service_.unwatch(monitor_->fd());
  for (auto& [ignored, plugged] : plugged_) {
    if (!plugged.reader) continue;
    plugged.reader->end();
    leaving_.push_back(plugged.reader);
  }
  const MonotonicTime deadline = now().mono + kLastWait;
  const auto all_gone = [this] {
    return std::all_of(leaving_.begin(), leaving_.end(), [](const auto& each) { return each->ended.load(); });
  };
  while (!all_gone() && now().mono < deadline) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

/// From now on; what was said before is for scan() to find.
Status Devices::open_monitor() {
  const auto udevd = UdevMonitor::udevd();
  auto monitor =
      UdevMonitor::open(recognition_.subsystems(), [this](const auto& of) { return recognition_.attributes_of(of); });
  if (!monitor) return monitor.error();
  if (monitor_) service_.unwatch(monitor_->fd());
  monitor_ = std::move(*monitor);
  service_.watch(monitor_->fd(), POLLIN, [this](short) { on_udev(); });
  udevd_ = udevd;
  return Done{};
}

/// It may come after this service, as in a container or early at boot, or be started again.
void Devices::look_for_udevd(MonotonicTime now) {
  next_udevd_look_ = now + kLookForUdevd;
  const auto there = UdevMonitor::udevd();
  const bool first = !std::exchange(scanned_, true);
  const bool other = there != udevd_;
  if (!there && (first || other)) {
    log(Level::warning, "no_udevd", "there is no udevd: what is plugged in is not noticed until it runs");
    udevd_.reset();
  }
  if (there && other) {
    if (Status opened = open_monitor(); !opened)
      return log_limited(limit_, now, Level::error, "udev", opened.error().text());
    log(Level::info, "udevd_heard", "udevd has been started; all is looked at again");
  }
  if (first || (there && other)) scan();
}

void Devices::scan() {
  const std::vector<Device> devices = monitor_->enumerate();
  std::set<std::string> there;
  for (const Device& device : devices) there.insert(device.syspath);
  for (const std::string& syspath : recognition_.present()) {
    if (!there.contains(syspath)) apply(recognition_.on_gone(syspath));
  }
  for (const Device& device : devices) apply(recognition_.on_present(device));
  notify_unknown();
}

void Devices::on_udev() {
  bool any = false;
  const bool whole = monitor_->drain([&](UdevMonitor::Event event) {
    any = true;
    on_event(std::move(event));
  });
  notify_unknown();
  if (!whole) {
    log_limited(limit_, now().mono, Level::warning, "udev_lost", "too much was said at once; all is looked at again");
    scan();
  }
  if (any && recognition_.refused() > 0) {
    log_limited(limit_, now().mono, Level::warning, "devices_refused",
                "there are more than " + std::to_string(Recognition::kMaxDevices));
  }
}

void Devices::on_event(UdevMonitor::Event event) {
  if (event.gone) return apply(recognition_.on_gone(event.device.syspath));
  if (!event.old_syspath.empty()) return apply(recognition_.on_moved(event.old_syspath, std::move(event.device)));
  apply(recognition_.on_present(std::move(event.device)));
}

void Devices::apply(Recognition::Change change) {
  for (const std::string& syspath : change.unplugged) unplug(syspath);
  for (FoundDevice& found : change.plugged) plug(std::move(found));
  unknown_changed_ = unknown_changed_ || change.unknown_changed;
}

void Devices::notify_unknown() {
  if (std::exchange(unknown_changed_, false)) listener_.on_unknown(recognition_.unknown());
}

void Devices::plug(FoundDevice found) {
  const std::string syspath = found.device.syspath;
  log(Level::info, "device_plugged",
      found.channels.front().plugged.info.device + " as " + found.rule->file + " says: " + syspath);
  Plugged& plugged = plugged_.insert_or_assign(syspath, Plugged{std::move(found), nullptr, 0, false}).first->second;
  for (const FoundChannel& channel : plugged.found.channels) listener_.on_plugged(channel.plugged);
  auto reader = start_reader(plugged.found, ++readers_, reader_pool_);
  if (!reader) {
    log_limited(limit_, now().mono, Level::error, "reader_not_started", reader.error().text());
    return fail_all(plugged, reader.error());
  }
  plugged.reader = std::move(*reader);
  reader_of_.emplace(readers_, syspath);
  next_look_ = std::min(next_look_, now().mono + kLook);
}

void Devices::unplug(const std::string& syspath) {
  const auto at = plugged_.find(syspath);
  if (at == plugged_.end()) return;
  log(Level::info, "device_unplugged", syspath);
  if (const auto& reader = at->second.reader) {
    reader->end();
    reader_of_.erase(reader->number);
    leaving_.push_back(reader);
  }
  const FoundDevice found = std::move(at->second.found);
  plugged_.erase(at);
  for (const FoundChannel& channel : found.channels) listener_.on_unplugged(channel.plugged.key);
}

void Devices::on_posts() {
  for (Post& post : reader_pool_->take()) on_post(std::move(post));
  if (reader_pool_->dropped() == dropped_) return;
  dropped_ = reader_pool_->dropped();
  log_limited(limit_, now().mono, Level::warning, "samples_dropped", std::to_string(dropped_) + " in all");
}

void Devices::on_post(Post post) {
  const auto at = reader_of_.find(post.reader);
  if (at == reader_of_.end()) return;  // of a device that is gone
  Plugged& plugged = plugged_.at(at->second);
  plugged.hangs_since = 0;
  if (const auto* sample = std::get_if<Sample>(&post.what)) return listener_.on_sample(*sample);
  plugged.picture_asked = false;
  listener_.on_picture(std::get<Picture>(post.what));
}

void Devices::look(Now now) {
  if (now.mono >= next_udevd_look_) look_for_udevd(now.mono);
  for (auto& [ignored, plugged] : plugged_) look_at(plugged, now.mono);
  std::erase_if(leaving_, [](const auto& each) { return each->ended.load(); });
  const bool none = plugged_.empty() && leaving_.empty();
  next_look_ = none ? next_udevd_look_ : now.mono + kLook;
}

void Devices::look_at(Plugged& plugged, MonotonicTime now) {
  if (!plugged.reader) return;
  const std::int64_t since = plugged.reader->busy_since;
  const double timeout_s = plugged.found.rule->timeout_s;
  if (since == 0 || since == plugged.hangs_since || now - MonotonicTime{since} < seconds(timeout_s)) return;
  plugged.hangs_since = since;
  const Error error = fail(Errc::timeout, "its device hangs: no answer for " + seconds_text(timeout_s),
                           "unplug it and plug it in again");
  log_limited(limit_, now, Level::warning, "device_hangs", plugged.found.device.syspath);
  fail_all(plugged, error);
}

void Devices::fail_all(const Plugged& plugged, const Error& error) {
  const Now at = now();
  const bool picture = plugged.found.rule->by == ReadBy::camera;
  for (const FoundChannel& channel : plugged.found.channels) {
    Sample sample;
    sample.key = channel.plugged.key;
    sample.time = at.utc;
    sample.measured = at.mono;
    sample.error = error;
    listener_.on_sample(sample);
    if (picture && plugged.picture_asked) listener_.on_picture({sample.key, {}, at.utc, {}, error});
  }
}

std::optional<Devices::Place> Devices::place(const std::string& key) {
  const auto at = plugged_.find(key.substr(0, key.rfind('#')));
  if (at == plugged_.end()) return std::nullopt;
  const auto& channels = at->second.found.channels;
  for (std::size_t i = 0; i < channels.size(); ++i) {
    if (channels[i].plugged.key == key) return Place(&at->second, i);
  }
  return std::nullopt;
}

void Devices::read_now(const std::string& key) {
  const auto found = place(key);
  if (found && found->first->reader) found->first->reader->ask(found->second);
}

void Devices::take_picture(const std::string& key) {
  const auto found = place(key);
  if (!found || !found->first->reader) return;
  found->first->picture_asked = true;
  found->first->reader->ask(found->second);
}

Devices::Counts Devices::counts() const {
  const auto left = std::count_if(leaving_.begin(), leaving_.end(), [](const auto& each) { return !each->ended; });
  return {plugged_.size(), reader_pool_->threads, static_cast<std::size_t>(left)};
}

}  // namespace trb::sensor
