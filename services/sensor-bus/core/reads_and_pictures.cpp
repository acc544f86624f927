// A part of SensorBusCore: what is requested of the sensors (one value, values now and then, a picture).
#include <algorithm>
#include <charconv>
#include <cmath>

#include "common/base/gives_way.hpp"
#include "services/sensor-bus/core/sensor_bus_core.hpp"

namespace trb::sensor {
namespace {

using std::chrono::milliseconds;

constexpr std::size_t kMaxReads = 64;
constexpr std::size_t kMaxPictures = 16;
constexpr std::size_t kMaxPicture = 1'000'000;  // SensorImage's bound
constexpr Duration kPicturePatience = std::chrono::seconds(10);
constexpr Duration kLeastReadPatience = std::chrono::seconds(3);
constexpr double kMostTimeout_s = 60;
constexpr std::string_view kImage = "image";

/// "21.5": as short as it can be read back exactly.
std::string plain_text(double number) {
  char text[32];
  const auto end = std::to_chars(std::begin(text), std::end(text), number).ptr;
  return {text, end};
}

std::string seconds_text(Duration time) {
  return plain_text(std::round(to_seconds(time) * 10) / 10) + " s";
}

}  // namespace

Duration SensorBusCore::patience_of(const std::string& name, double timeout_s) const {
  if (timeout_s > 0) return seconds(std::min(timeout_s, kMostTimeout_s));
  const Sensor* sensor = sensors_.find(name);
  const Duration periods = sensor == nullptr ? Duration{} : 3 * sensor->period;
  return std::clamp<Duration>(periods, kLeastReadPatience, seconds(kMostTimeout_s));
}

/// It names the sensor as it was asked for, by which a requester of several knows the one.
void SensorBusCore::refuse(const Inbound& asked, const Error& error, Outbox& out) {
  std::string about;
  Takes<SensorRead, SensorWatch, SensorSnapshot>::dispatch(asked.body, [&](const auto& body) { about = body.sensor; });
  out.nack(asked, error, std::move(about));
}

/// Who asks too much keeps nobody else from asking. False: it is this node.
bool SensorBusCore::make_room(std::vector<Requester>& waiting, const Inbound& asked, const Error& why, Outbox& out) {
  const auto source_of = [](const Requester& one) { return one.asked.source; };
  const std::string other = gives_way(waiting, asked.source, source_of);
  if (other == asked.source) return false;
  const auto newest =
      std::find_if(waiting.rbegin(), waiting.rend(), [&](const Requester& one) { return one.asked.source == other; });
  refuse(newest->asked, why, out);
  waiting.erase(std::prev(newest.base()));
  return true;
}

void SensorBusCore::begin_read(const Inbound& asked, const SensorRead& body, Now now, Outbox& out) {
  const auto name = sensors_.resolve(body.sensor, body.identity);
  if (!name) return refuse(asked, name.error(), out);
  const Sensor* sensor = sensors_.find(*name);
  if (sensor != nullptr && sensor->info.kind == kImage)
    return refuse(asked, fail(Errc::bad_value, *name + " tells pictures", "ask for a sensor_snapshot"), out);
  const Error full = fail(Errc::queue_full, "64 wait for a value already", "wait, or watch the sensor");
  if (reads_.size() >= kMaxReads && !make_room(reads_, asked, full, out)) return refuse(asked, full, out);
  // Whoever has given up by then gets no answer.
  const Duration patience = std::min<Duration>(patience_of(*name, body.timeout_s), milliseconds(asked.remaining_ms));
  reads_.push_back({asked, *name, patience, now.mono + patience});
  asked_changed_ = true;
  settle_rules();  // before the value can come
  if (sensor != nullptr && !sensor->fed()) order(ReadNow{sensor->key});
}

void SensorBusCore::order_watch(const Inbound& asked, const SensorWatch& body, Now now, Outbox& out) {
  const auto name = sensors_.resolve(body.sensor, body.identity);
  if (!name) return refuse(asked, name.error(), out);
  const Sensor* sensor = sensors_.find(*name);
  if (sensor != nullptr && sensor->info.kind == kImage)
    return refuse(asked, fail(Errc::bad_value, *name + " tells pictures", "ask for a sensor_snapshot now and then"),
                  out);
  if (Status ordered = watches_.order(asked, body, *name, now, out); !ordered)
    return refuse(asked, ordered.error(), out);
  out.reply(asked, Ack{"accepted", sensor == nullptr ? "no sensor has told of that name yet" : ""});
}

// ---- pictures

void SensorBusCore::begin_picture(const Inbound& asked, const SensorSnapshot& body, Now now, Outbox& out) {
  const auto name = sensors_.resolve(body.sensor, body.identity);
  if (!name) return refuse(asked, name.error(), out);
  const Sensor* sensor = sensors_.find(*name);
  if (sensor == nullptr)
    return refuse(asked, fail(Errc::unknown_target, "'" + *name + "' is no sensor", "there are: " + sensors_.names()),
                  out);
  if (sensor->info.kind != kImage)
    return refuse(asked, fail(Errc::bad_value, *name + " tells no pictures", "ask for a sensor_read"), out);
  const Error full = fail(Errc::queue_full, "16 wait for a picture already", "wait");
  if (pictures_.size() >= kMaxPictures && !make_room(pictures_, asked, full, out)) return refuse(asked, full, out);
  const bool asked_already = std::ranges::any_of(pictures_, [&](const Requester& one) { return one.name == *name; });
  const Duration patience = std::min<Duration>(kPicturePatience, milliseconds(asked.remaining_ms));
  pictures_.push_back({asked, *name, patience, now.mono + patience});
  if (!asked_already) order(TakePicture{sensor->key});
}

void SensorBusCore::on_picture(const Picture& picture, Now now, Outbox& out) {
  const Sensor* sensor = sensors_.find_key(picture.key);
  if (sensor == nullptr) return;
  const std::string name = sensor->info.name;
  auto error = picture.error;
  if (!error && picture.bytes.size() > kMaxPicture)
    error = fail(Errc::too_large, name + ": its picture has over 1 MB", "let the camera give smaller ones");
  if (error) {
    refuse_pictures(name, *error, out);
    sensors_.failed(name, error->what);
  } else {
    send_picture({name, sensor->info.identity, picture.media_type, picture.time.ns, {picture.bytes}}, out);
    sensors_.set_value(name, {}, now.mono, now.mono);
  }
  settle(now, out);
}

void SensorBusCore::refuse_pictures(const std::string& name, const Error& error, Outbox& out) {
  std::erase_if(pictures_, [&](const Requester& one) {
    if (one.name != name) return false;
    refuse(one.asked, fail(Errc::robot_error, error.what, error.hint), out);
    return true;
  });
}

void SensorBusCore::send_picture(const SensorImage& image, Outbox& out) {
  std::erase_if(pictures_, [&](const Requester& one) {
    if (one.name != image.sensor) return false;
    out.sends.push_back({.type = MessageType::information,
                         .target = one.asked.source,
                         .reply_to = one.asked.id,
                         .flags = kFlagLossy,
                         .body = image});
    return true;
  });
}

// ---- values

void SensorBusCore::on_sample(const Sample& sample, Now now, Outbox& out) {
  const Sensor* sensor = sensors_.find_key(sample.key);
  if (sensor == nullptr) return;  // it was unplugged while it was read
  if (sample.error) return read_failed(*sensor, *sample.error, now, out);
  BusArgument argument = sample.is_text ? BusArgument(sample.text) : BusArgument(sample.number);
  auto value = read_bus_value({std::move(argument), sensor->info.unit, sample.time.ns});
  if (!value) return read_failed(*sensor, value.error(), now, out);
  const bool other_kind = !sensor->value || sensor->value->is_text != value->is_text;
  const auto patience = sensor->patience();
  if (patience && now.mono - sample.measured > *patience) value->quality = "stale";
  const std::string name = sensor->info.name;
  sensors_.set_value(name, *value, sample.measured, now.mono);
  if (other_kind) announce(*sensor);
  order(EmitValue{name, std::move(*value)});
  settle(now, out);
}

/// Those who wait get the error in the reader's own words.
void SensorBusCore::read_failed(const Sensor& sensor, const Error& error, Now now, Outbox& out) {
  const std::string name = sensor.info.name;
  const SensorState state = error.code == Errc::missing ? SensorState::silent : SensorState::failed;
  const bool changed = sensor.info.state != state;
  out.count(state == SensorState::silent ? "sensor.silent" : "sensor.failed");
  if (changed) out.log(LogLevel::warning, "sensor_failed", name + ": " + error.text());
  sensors_.failed(name, error.what, state);
  const auto is_over = [&](const Requester& one) {
    if (one.name != name) return false;
    refuse(one.asked, fail(Errc::robot_error, name + ": " + error.what, error.hint), out);
    return true;
  };
  asked_changed_ = std::erase_if(reads_, is_over) != 0 || asked_changed_;
  if (changed) send_last_value(name, now, out);
  settle(now, out);
}

/// Who watches a sensor that sends nothing any more gets what it sent last, and how old that is.
void SensorBusCore::send_last_value(const std::string& name, Now now, Outbox& out) {
  const Sensor* sensor = sensors_.find(name);
  if (sensor == nullptr || !sensor->value || !watches_.any_of(name)) return;
  SensorReading reading = reading_of(name, *sensor->value, now);
  reading.quality = "stale";
  // A program may say no time, or one by a clock that is ahead: it has measured before the value came.
  const Duration age = sensor->measured ? now.mono - *sensor->measured : Duration{};
  if (sensor->fed() && to_seconds(age) > reading.age_s) {
    reading.age_s = to_seconds(age);
    reading.time = (now.utc - age).ns;
  }
  watches_.send_at_once(name, reading, out);
}

SensorReading SensorBusCore::reading_of(const std::string& name, const BusValue& value, Now now) const {
  SensorReading reading{name, "", value.unit, value.is_text, value.number, value.text, now.utc.ns, 0, value.quality};
  if (value.time) {
    // A clock that is ahead of this one has measured now.
    reading.time = std::min(*value.time, now.utc.ns);
    reading.age_s = to_seconds(Duration{now.utc.ns - reading.time});
  }
  const Sensor* sensor = sensors_.find(name);
  if (sensor == nullptr) return reading;
  reading.identity = sensor->info.identity;
  if (reading.unit.empty()) reading.unit = sensor->info.unit;
  const bool measured_here = !sensor->fed() && sensor->value && sensor->measured && sensor->value->time == value.time;
  if (measured_here) reading.age_s = to_seconds(now.mono - *sensor->measured);
  const auto patience = sensor->patience();
  if (reading.quality == "good" && patience && reading.age_s > to_seconds(*patience)) reading.quality = "stale";
  return reading;
}

void SensorBusCore::deliver(const std::string& name, const SensorReading& reading, Now now, Outbox& out) {
  const auto is_over = [&](const Requester& one) {
    if (one.name != name) return false;
    if (const auto* word = get_if<Opaque>(&one.asked.body)) {
      out.reply(one.asked, Opaque{word->subtype, reading.is_text ? reading.text : plain_text(reading.number)});
    } else {
      out.reply(one.asked, reading);
    }
    return true;
  };
  asked_changed_ = std::erase_if(reads_, is_over) != 0 || asked_changed_;
  watches_.send(name, reading, now, out);
}

// ---- what did not come

void SensorBusCore::expire(Now now, Outbox& out) {
  watches_.expire(now.mono);
  const Sensors::Late late = sensors_.check(now.mono);
  for (const std::string& name : late.silent) send_last_value(name, now, out);
  for (const std::string& name : late.gone) gone(name, "is fed by no program any more", out);
  const auto is_over = [&](const Requester& one) {
    if (one.deadline > now.mono) return false;
    time_out(one, out);
    return true;
  };
  asked_changed_ = std::erase_if(reads_, is_over) != 0 || asked_changed_;
  std::erase_if(pictures_, is_over);
}

void SensorBusCore::time_out(const Requester& requester, Outbox& out) const {
  const Sensor* sensor = sensors_.find(requester.name);
  const std::string nothing = requester.name + " told nothing in " + seconds_text(requester.patience);
  if (!bus_up_) {
    return refuse(requester.asked,
                  fail(Errc::timeout, nothing + ": the D-Bus is not there: " + bus_fault_,
                       "start it, or name another in node.json: \"dbus\""),
                  out);
  }
  if (sensor == nullptr) {
    return refuse(
        requester.asked,
        fail(Errc::unknown_target,
             "'" + requester.name + "' is no sensor, and no program told of it in " + seconds_text(requester.patience),
             "there are: " + sensors_.names()),
        out);
  }
  const std::string why = sensor->info.detail.empty() ? "" : ": " + sensor->info.detail;
  refuse(requester.asked, fail(Errc::timeout, nothing + why, "see trb sensor list; give it more time: --timeout"), out);
}

}  // namespace trb::sensor
