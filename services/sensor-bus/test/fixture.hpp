// A sensor-bus core in virtual time: the test plays the router, the devices and the D-Bus.
#pragma once

#include <doctest/doctest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "services/sensor-bus/core/sensor_bus_core.hpp"

namespace trb::sensor {

/// A D-Bus that gives what is emitted to whoever is subscribed, when the test says so.
struct Fixture {
  SensorBusCore core{"conveyor", robots_words({"speed"})};
  Now now{{1'000'000'000}, {1'700'000'000'000'000'000}};
  Outbox out;
  std::vector<Effect> effects;
  std::uint64_t last_id = 0;

  Fixture() {
    core.on_welcome({"conveyor", Role::robot, 1}, now, out);
    bus_event(BusUp{""});
    clear();
  }

  void clear() {
    out.clear();
    effects.clear();
  }
  void collect() {
    for (Effect& effect : core.take_effects()) effects.push_back(std::move(effect));
  }
  void pass(Duration time) {
    now.mono = now.mono + time;
    now.utc = now.utc + time;
  }
  /// Lets the time pass, deadline by deadline.
  void wait(Duration time) {
    const MonotonicTime end = now.mono + time;
    while (core.next_deadline() && *core.next_deadline() <= end) {
      pass(std::max(Duration{}, *core.next_deadline() - now.mono));
      core.tick(now, out);
      collect();
    }
    pass(end - now.mono);
  }

  // ---- the devices
  void plug(const std::string& key, const std::string& name, const std::string& serial = "",
            const std::string& kind = "temperature", double every_s = 1) {
    core.on_plugged({key, {name, kind, "degC", serial, "Acme T1", {}, {}}, every_s}, now, out);
    collect();
  }
  void unplug(const std::string& key) {
    core.on_unplugged(key, now, out);
    collect();
  }
  void sample(const std::string& key, double number) {
    core.on_sample({key, false, number, "", now.utc, now.mono, {}}, now, out);
    collect();
  }
  void fails(const std::string& key, const std::string& what) {
    core.on_sample({key, false, 0, "", now.utc, now.mono, fail(Errc::io_error, what, "replace it")}, now, out);
    collect();
  }

  // ---- the D-Bus
  void bus_event(BusEvent one) {
    core.on_bus_events({std::move(one)}, now, out);
    collect();
  }
  /// What was emitted comes back to who is subscribed.
  void echo() {
    for (const EmitValue& value : take<EmitValue>()) bus_event(SignalHeard{value.name, true, value.value});
  }
  void program(const std::string& name, double number, const std::string& unit = "") {
    BusValue value;
    value.number = number;
    value.unit = unit;
    bus_event(ProgramHeard{name});
    bus_event(SignalHeard{name, false, value});
  }
  void device_sends(const std::string& key, double number) {
    sample(key, number);
    echo();
  }

  template <class T>
  std::vector<T> take() {
    std::vector<T> found;
    std::erase_if(effects, [&](Effect& effect) {
      auto* one = std::get_if<T>(&effect);
      if (one != nullptr) found.push_back(std::move(*one));
      return one != nullptr;
    });
    return found;
  }
  /// "+humidity -temperature": rules made and removed since the last call.
  std::string rules() {
    std::string text;
    for (const Effect& effect : effects) {
      if (const auto* made = std::get_if<Subscribe>(&effect)) text += (text.empty() ? "+" : " +") + made->name;
      if (const auto* gone = std::get_if<Unsubscribe>(&effect)) text += (text.empty() ? "-" : " -") + gone->name;
    }
    take<Subscribe>();
    take<Unsubscribe>();
    return text;
  }

  // ---- the router
  std::uint64_t ask(Body body, const std::string& source = "ur3", std::uint64_t slot = 3) {
    const std::uint64_t id = slot << 48U | ++last_id;
    core.on({MessageType::request, source, "conveyor", id, 0, 0, 30'000, std::move(body)}, now, out);
    collect();
    return id;
  }
  std::uint64_t read(const std::string& sensor, double timeout_s = 0) { return ask(SensorRead{sensor, "", timeout_s}); }
  std::uint64_t watch(const std::string& sensor, double every_s = 1, double lease_s = 10, std::uint64_t number = 7,
                      const std::string& source = "ur3") {
    return ask(SensorWatch{sensor, "", number, every_s, lease_s}, source);
  }

  /// Everything said to `id`'s requester as its answer, a line each: "reading temperature 21.5 good", "nack timeout:
  /// …".
  std::string answer(std::uint64_t id) {
    std::string text;
    for (const Send& send : out.sends) {
      if (send.reply_to != id) continue;
      text += text.empty() ? "" : "\n";
      if (const auto* nack = get_if<Nack>(&send.body)) text += "nack " + nack->code + ": " + nack->what;
      if (const auto* ack = get_if<Ack>(&send.body)) text += "ack " + ack->state;
      if (const auto* word = get_if<Opaque>(&send.body)) text += word->subtype + " " + word->data;
      if (const auto* image = get_if<SensorImage>(&send.body)) text += "image " + image->bytes.bytes;
      if (const auto* one = get_if<SensorReading>(&send.body)) text += "reading " + text_of(*one);
    }
    return text;
  }
  static std::string text_of(const SensorReading& one) {
    std::string number = std::to_string(one.number);
    number.resize(number.find('.') + 2);
    return one.sensor + " " + (one.is_text ? one.text : number) + " " + one.quality;
  }
  /// What the fleet was told last: "temperature:ok humidity:unread".
  std::string told() {
    const auto all = sent<NodeSensors>(out);
    if (all.empty()) return "nothing";
    std::string text;
    for (const SensorInfo& info : all.back().sensors) {
      text += (text.empty() ? "" : " ") + info.name + ":" + std::string(name_of(info.state));
    }
    return text;
  }
  SensorInfo info(const std::string& name) {
    const std::uint64_t id = ask(SensorListRequest{});
    for (const Send& send : out.sends) {
      const auto* table = get_if<SensorTable>(&send.body);
      if (table == nullptr || send.reply_to != id) continue;
      for (const SensorInfo& one : table->sensors) {
        if (one.name == name) return one;
      }
    }
    return {};
  }
};

}  // namespace trb::sensor
