// How devices are read: the kinds of readers, which a rule of sensors/*.json names as "read".
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

namespace trb {

/// Properties of every device that one kind of reader reads.
struct ReaderKind {
  bool device_file = true;  ///< it is read through its file below /dev, and without one it is not a sensor
  bool one_sensor = false;  ///< it is one sensor
  bool period = true;  ///< it has a period: without one it sends a value when there is one, or on request, and a rule
                       ///< gives its sensors neither "every_s" nor "scale" and "offset"
};

// One line a kind: its word, and what of ReaderKind is not as above. services/sensor-bus/readers has the reader of it,
// run_KIND.
// attributes: files of the device's folder below /sys. w1: likewise, with a checksum. nmea, line: lines of a serial
// port. keyboard: a reader that types what it has read. camera: pictures when asked for.
#define TRB_READER_KINDS(KIND)                        \
  KIND(attributes, .device_file = false)              \
  KIND(w1, .device_file = false, .one_sensor = true)  \
  KIND(nmea)                                          \
  KIND(line)                                          \
  KIND(keyboard, .one_sensor = true, .period = false) \
  KIND(camera, .one_sensor = true, .period = false)

#define TRB_WORD(KIND, ...) KIND,
enum class ReadBy : std::uint8_t { TRB_READER_KINDS(TRB_WORD) };
#undef TRB_WORD

#define TRB_NAME(KIND, ...) std::string_view(#KIND),
constexpr auto enum_names(ReadBy /*kind*/) {
  return std::array{TRB_READER_KINDS(TRB_NAME)};
}
#undef TRB_NAME

#define TRB_KIND(KIND, ...) ReaderKind{__VA_ARGS__},
constexpr ReaderKind kind_of(ReadBy by) {
  return std::array{TRB_READER_KINDS(TRB_KIND)}[static_cast<std::size_t>(by)];
}
#undef TRB_KIND

}  // namespace trb
