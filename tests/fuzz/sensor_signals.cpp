// What programs send on D-Bus, and requests for it: the arguments of a signal, and the sensor-bus behind them.
#include <cmath>
#include <cstring>
#include <set>

#include "proto/value.hpp"
#include "services/sensor-bus/core/sensor_bus_core.hpp"
#include "tests/fuzz/target.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::sensor;

/// Reads the input piece by piece.
class Cursor {
 public:
  explicit Cursor(BytesView rest) : rest_(rest) {}
  [[nodiscard]] bool more() const { return !rest_.empty(); }
  std::uint8_t byte() { return static_cast<std::uint8_t>(bytes(1).empty() ? 0 : last_.front()); }
  template <class T>
  T number() {
    T out{};
    const BytesView raw = bytes(sizeof out);
    std::memcpy(&out, raw.data(), raw.size());
    return out;
  }
  BytesView bytes(std::size_t size) {
    last_ = rest_.substr(0, size);
    rest_.remove_prefix(last_.size());
    return last_;
  }

 private:
  BytesView rest_;
  BytesView last_;
};

BusArgument argument(Cursor& in) {
  switch (in.byte() % 6) {
    case 0:
      return in.byte() != 0;
    case 1:
      return in.number<std::int64_t>();
    case 2:
      return in.number<std::uint64_t>();
    case 3:
      return in.number<double>();
    case 4: {
      // Also long ones, from few bytes.
      const std::size_t times = in.byte() % 4 == 0 ? 300 : 1;
      const BytesView text = in.bytes(in.byte() % 32);
      std::string out;
      for (std::size_t i = 0; i < times; ++i) out += text;
      return out;
    }
    default:
      return std::monostate{};
  }
}

std::optional<BusValue> value(Cursor& in) {
  std::vector<BusArgument> arguments;
  for (int left = in.byte() % 6; left > 0; --left) arguments.push_back(argument(in));
  auto read = read_bus_value(arguments);
  if (!read) return std::nullopt;
  require(std::isfinite(read->number), "a number is finite");
  require(is_utf8(read->text) && read->text.size() <= kMaxValueText, "a text is short and UTF-8");
  require(is_utf8(read->unit) && read->unit.size() <= 16, "a unit is short and UTF-8");
  require(!read->time || *read->time > 0, "a time is one");
  return *read;
}

/// The sensor-bus with any events; each request gets one answer, and no rule outlives its requester.
class Play {
 public:
  explicit Play(Cursor in) : in_(in) {
    core_.on_welcome({"hall", Role::robot, 1}, now_, out_);
    settle();
  }

  void run() {
    for (int steps = 0; in_.more() && steps < 2000; ++steps) {
      step();
      settle();
    }
    core_.on_bus_events({BusUp{""}}, now_, out_);
    rules_.clear();
    settle();
    for (int i = 0; i < 200; ++i) pass(std::chrono::seconds(1));
    require(rules_.empty(), "no rule is left when nobody asks any more");
    require(open_.empty(), "everybody who asks is answered");
  }

 private:
  std::string name() { return "s" + std::to_string(in_.byte() % 8); }
  std::string key() { return "usb" + std::to_string(in_.byte() % 8) + "#" + std::to_string(in_.byte() % 2); }

  void step() {
    switch (in_.byte() % 9) {
      case 0:
        return hear(in_.byte() % 2 == 0);
      case 1:
        return core_.on_bus_events({ProgramHeard{name()}}, now_, out_);
      case 2:
        return ask(SensorRead{name(), in_.byte() % 4 == 0 ? "SN" : "", in_.number<double>()});
      case 3:
        return ask(SensorWatch{name(), "", in_.byte() % 4U, in_.number<double>(), in_.number<double>()});
      case 4: {
        const SensorInfo info{std::string(in_.bytes(in_.byte() % 8)),
                              in_.byte() % 4 == 0 ? "image" : "t",
                              "degC",
                              in_.byte() % 2 == 0 ? "SN" : "",
                              "",
                              {},
                              ""};
        return core_.on_plugged({key(), info, in_.number<double>()}, now_, out_);
      }
      case 5:
        return core_.on_unplugged(key(), now_, out_);
      case 6: {
        Sample sample{key(), in_.byte() % 2 == 0, in_.number<double>(), std::string(in_.bytes(4)), now_.utc, now_.mono,
                      {}};
        if (in_.byte() % 4 == 0) sample.error = fail(Errc::io_error, "it hangs");
        return core_.on_sample(sample, now_, out_);
      }
      case 7:
        if (in_.byte() % 2 == 0) return core_.on_bus_events({BusDown{"gone"}}, now_, out_);
        rules_.clear();
        return core_.on_bus_events({BusUp{""}}, now_, out_);
      default:
        return pass(std::chrono::milliseconds(in_.byte() * 20));
    }
  }

  void hear(bool own) {
    const std::string name = this->name();
    if (auto heard = value(in_)) core_.on_bus_events({SignalHeard{name, own, std::move(*heard)}}, now_, out_);
  }

  void ask(Body body) {
    const std::uint64_t id = ++last_;
    open_.insert(id);
    core_.on({MessageType::request, "ur3", "hall", id, 0, 0, 30'000, std::move(body)}, now_, out_);
  }

  void pass(Duration time) {
    now_ = {now_.mono + time, now_.utc + time};
    core_.tick(now_, out_);
    settle();
  }

  void settle() {
    for (const Effect& effect : core_.take_effects()) {
      if (const auto* made = std::get_if<Subscribe>(&effect))
        require(rules_.insert(made->name).second, "one rule a name");
      if (const auto* gone = std::get_if<Unsubscribe>(&effect))
        require(rules_.erase(gone->name) == 1, "a rule that is there");
    }
    for (const Send& send : out_.sends) {
      require(decode_body(subtype_of(send.body), encode_body(send.body)).ok(), "what it says can be read");
      if (const auto* reading = get_if<SensorReading>(&send.body);
          reading != nullptr && reading->watch + reading->count > 0)
        continue;
      // A watch that ends reports that by a second answer: the sensor is gone.
      const bool end_of_watch = holds_alternative<Nack>(send.body) && watched_.count(send.reply_to) != 0;
      if (holds_alternative<Ack>(send.body)) watched_.insert(send.reply_to);
      if (send.reply_to != 0) require(open_.erase(send.reply_to) == 1 || end_of_watch, "one answer each");
    }
    out_.clear();
  }

  Cursor in_;
  SensorBusCore core_{"hall"};
  Now now_{{1'000'000'000}, {1'700'000'000'000'000'000}};
  Outbox out_;
  std::set<std::string> rules_;
  std::set<std::uint64_t> open_;
  std::set<std::uint64_t> watched_;
  std::uint64_t last_ = 0;
};

Bytes raw(double number) {
  Bytes out(sizeof number, '\0');
  std::memcpy(out.data(), &number, sizeof number);
  return out;
}

}  // namespace

std::vector<Bytes> seeds() {
  const Bytes read = Bytes("\x02\x01\x01", 3) + raw(0);
  const Bytes watch = Bytes("\x03\x01\x02", 3) + raw(0.5) + raw(10);
  const Bytes heard = Bytes("\x00\x01\x01\x02\x03", 5) + raw(47) + Bytes("\x04\x01\x07percent", 10);
  const Bytes plug = Bytes("\x04\x02s1\x01\x01\x01\x01", 8) + raw(1);
  const Bytes sample = Bytes("\x06\x01\x01\x01", 4) + raw(21.5) + Bytes("abcd\x01", 5);
  const Bytes bus = Bytes("\x07\x01", 2);
  return {bus + read + heard, bus + watch + heard + heard + Bytes("\x08\xff", 2) + heard, bus + plug + read + sample,
          bus + plug + watch + Bytes("\x05\x01\x01", 3) + read};
}

void run(BytesView input) {
  Cursor in(input);
  value(in);
  const auto name = sensor_of("/trbots/" + Bytes(input), "trbots." + Bytes(input));
  require(!name || is_sensor_name(*name), "a sensor's name is one");
  require(is_sensor_name(to_sensor_name(input)), "a wish becomes a name");
  Play(Cursor(input)).run();
}

}  // namespace trb::fuzz
