// One value, or one picture, of a sensor of the fleet.
#pragma once

#include <optional>

#include "common/operator/find_sensor.hpp"
#include "common/operator/session.hpp"

namespace trb::op {

/// The sensor that is meant, in the routing table as it is now. Errors: those of find_sensor and Session::request.
void look_up_sensor(Session& session, SensorWish wish, const Callback<FoundSensor>& done);

/// The next value that the sensor tells. With `limit_s` its node waits so long for it, else three of its periods; the
/// answer is waited for `wait` and a second more. Errors: those of Session::request.
void read_sensor(Session& session, const FoundSensor& sensor, std::optional<double> limit_s, Duration wait,
                 const Callback<SensorReading>& done);

/// A picture. It may get lost on its way: it is asked for three times, a third of `wait` each. Errors: those of
/// Session::request.
void take_picture(Session& session, const FoundSensor& sensor, Duration wait, const Callback<SensorImage>& done);

}  // namespace trb::op
