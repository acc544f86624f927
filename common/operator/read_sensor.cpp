#include "common/operator/read_sensor.hpp"

#include "common/operator/routes.hpp"

namespace trb::op {
namespace {

constexpr int kPictureTries = 3;

template <class Body>
Callback<Message> decoded(const Callback<Body>& done) {
  return on_success<Message>(done, [done](const Message& answer) { done(decode<Body>(answer.data)); });
}

void take_picture(Session& session, const FoundSensor& sensor, Duration wait, int tries,
                  const Callback<SensorImage>& done) {
  const auto answered = [&session, sensor, wait, tries, done](const Result<Message>& answer) {
    const bool again = !answer && answer.error().code == Errc::timeout && tries > 1;
    if (again) return take_picture(session, sensor, wait, tries - 1, done);
    decoded(done)(answer);
  };
  const SensorSnapshot body{sensor.info.name, sensor.info.identity};
  session.request(Send{.type = MessageType::request, .target = sensor.node, .body = body}, answered, wait);
}

}  // namespace

void look_up_sensor(Session& session, SensorWish wish, const Callback<FoundSensor>& done) {
  const auto find = [wish = std::move(wish), done](const RouteTable& table) { done(find_sensor(table, wish)); };
  request_routes(session, on_success<RouteTable>(done, find));
}

void read_sensor(Session& session, const FoundSensor& sensor, std::optional<double> limit_s, Duration wait,
                 const Callback<SensorReading>& done) {
  const SensorRead body{sensor.info.name, sensor.info.identity, limit_s.value_or(0)};
  const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(wait) + std::chrono::seconds(1);
  const auto remaining_ms = static_cast<std::uint32_t>(left.count());
  session.request(Send{.type = MessageType::request, .target = sensor.node, .remaining_ms = remaining_ms, .body = body},
                  decoded(done), wait + std::chrono::seconds(1));
}

void take_picture(Session& session, const FoundSensor& sensor, Duration wait, const Callback<SensorImage>& done) {
  take_picture(session, sensor, wait / kPictureTries, kPictureTries, done);
}

}  // namespace trb::op
