// One value, or one picture, of a sensor of the fleet.
#pragma once

#include <optional>

#include "common/operator/find_sensor.hpp"
#include "common/operator/session.hpp"

namespace trb::op {

/// Finds the sensor that is meant in the present routing table. Errors: those of find_sensor and Session::request.
void look_up_sensor(Session& session, SensorWish wish, const Callback<FoundSensor>& done);

/// The sensor's next value. With `limit_s` its node waits that long for it, else three of its periods; the answer is
/// awaited for `wait` plus a second. Errors: those of Session::request.
void read_sensor(Session& session, const FoundSensor& sensor, std::optional<double> limit_s, Duration wait,
                 const Callback<SensorReading>& done);

/// A picture. It may be lost on the way: it is requested up to three times, a third of `wait` each. Errors: those of
/// Session::request.
void take_picture(Session& session, const FoundSensor& sensor, Duration wait, const Callback<SensorImage>& done);

}  // namespace trb::op
