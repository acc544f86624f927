#include "services/sensor-bus/io/bus_connection.hpp"

#include <cerrno>

#include "common/service/service.hpp"
#include "services/sensor-bus/io/bus_message.hpp"

namespace trb::sensor {
namespace {

constexpr const char* kOwnName = "trbots.sensors";
constexpr const char* kMember = "value";
constexpr std::chrono::seconds kPatience{1};
constexpr int kBatch = 256;
/// Who feeds often is told of now and then; more is not needed to know that a sensor lives.
constexpr Duration kTellEvery = std::chrono::milliseconds(500);
constexpr std::size_t kMostTold = 1024;

std::unique_ptr<sdbus::IConnection> connect(const std::string& where) {
  if (where == "system") return sdbus::createSystemBusConnection();
  if (where == "session") return sdbus::createSessionBusConnection();
  return sdbus::createSessionBusConnectionWithAddress(where);
}

std::string interface_of(const std::string& name) {
  return "trbots." + name;
}
std::string path_of(const std::string& name) {
  return "/trbots/" + name;
}

}  // namespace

BusConnection::BusConnection(const std::string& where, Tell tell)
    : tell_(std::move(tell)), work_(connect(where)), watch_(connect(where)), own_(work_->getUniqueName()) {
  work_->setMethodCallTimeout(kPatience);
  watch_->setMethodCallTimeout(kPatience);
  own_name();
  bus_ = sdbus::createProxy(*work_, "org.freedesktop.DBus", "/org/freedesktop/DBus");
  watch_->addMatch(
      "type='signal',path_namespace='/trbots',member='value'",
      [this](sdbus::Message& message) { on_discovered(message); }, sdbus::floating_slot);
}

void BusConnection::own_name() {
  try {
    work_->requestName(kOwnName);
  } catch (const sdbus::Error& problem) {
    if (problem.getName() != "org.freedesktop.DBus.Error.AccessDenied") {
      throw std::runtime_error(std::string(kOwnName) +
                               " is taken: another node's sensor-bus is on this bus; give each a " +
                               "bus of its own, \"dbus\" in node.json (" + problem.what() + ")");
    }
    note_ = std::string("the bus does not let this service be ") + kOwnName + ": install deploy/dbus/trbots.conf";
  }
}

void BusConnection::carry_out(const Effect& effect) {
  std::visit(Overloaded{[&](const Announce& order) { announce(order); },
                        [&](const Withdraw& order) { objects_.erase(order.name); },
                        [&](const Subscribe& order) { subscribe(order.name); },
                        [&](const Unsubscribe& order) { rules_.erase(order.name); },
                        [&](const EmitValue& order) { emit(order); }, [](const auto&) {}},
             effect);
}

void BusConnection::announce(const Announce& order) {
  const SensorInfo& info = order.info;
  const std::string interface = interface_of(info.name);
  objects_.erase(info.name);
  auto object = sdbus::createObject(*work_, path_of(info.name));
  const char* const signature = order.is_text ? "ssxs" : "dsxs";
  object->registerSignal(interface, kMember, signature, {"value", "unit", "time", "quality"});
  for (const auto& [name, text] :
       {std::pair{"Kind", info.kind}, {"Unit", info.unit}, {"Device", info.device}, {"Identity", info.identity}}) {
    object->registerProperty(name).onInterface(interface).withGetter([text = text] { return text; });
  }
  object->finishRegistration();
  objects_[info.name] = std::move(object);
}

void BusConnection::subscribe(const std::string& name) {
  if (rules_.count(name) != 0) return;
  rules_[name] = work_->addMatch(
      "type='signal',interface='" + interface_of(name) + "',path='" + path_of(name) + "',member='" + kMember + "'",
      [this, name](sdbus::Message& message) { on_subscribed(name, message); });
}

void BusConnection::emit(const EmitValue& order) {
  const auto object = objects_.find(order.name);
  if (object == objects_.end()) return;
  const BusValue& value = order.value;
  sdbus::Signal signal = object->second->createSignal(interface_of(order.name), kMember);
  if (value.is_text) {
    signal << value.text;
  } else {
    signal << value.number;
  }
  signal << value.unit << value.time.value_or(0) << value.quality;
  object->second->emitSignal(signal);
}

void BusConnection::on_subscribed(const std::string& name, sdbus::Message& message) {
  auto value = [&]() -> Result<BusValue> {
    try {
      return read_bus_value(read_arguments(message));
    } catch (const sdbus::Error& problem) {
      return fail(Errc::malformed, problem.what());
    }
  }();
  const std::string sender = message.getSender();
  if (value) return tell_(SignalHeard{name, sender == own_, std::move(*value)});
  tell_(SignalRefused{"refused.signal_" + std::string(errc_name(value.error().code)),
                      interface_of(name) + " of " + sender + ": " + value.error().text()});
}

void BusConnection::on_discovered(const sdbus::Message& message) {
  const std::string sender = message.getSender();
  if (sender == own_) return;
  const auto name = sensor_of(message.getPath(), message.getInterfaceName());
  if (!name) {
    return tell_(SignalRefused{"refused.signal_name", message.getInterfaceName().substr(0, 80) + " at " +
                                                          message.getPath().substr(0, 80) + " of " + sender +
                                                          ": emit trbots.NAME at /trbots/NAME"});
  }
  const MonotonicTime now = trb::now().mono;
  if (told_.size() >= kMostTold) told_.clear();
  const auto [at, is_new] = told_.try_emplace(*name, now);
  if (!is_new && now - at->second < kTellEvery) return;
  at->second = now;
  tell_(ProgramHeard{*name});
}

bool BusConnection::process() {
  for (sdbus::IConnection* connection : {work_.get(), watch_.get()}) {
    int left = kBatch;
    while (left > 0 && connection->processPendingRequest()) --left;
    if (left == 0) return false;
  }
  return true;
}

void BusConnection::ping() {
  std::string id;
  bus_->callMethod("GetId").onInterface("org.freedesktop.DBus").storeResultsTo(id);
}

std::vector<BusConnection::Wait> BusConnection::waits() const {
  std::vector<Wait> out;
  for (const sdbus::IConnection* connection : {work_.get(), watch_.get()}) {
    const auto data = connection->getEventLoopPollData();
    out.push_back({data.fd, data.events, data.getPollTimeout()});
  }
  return out;
}

}  // namespace trb::sensor
