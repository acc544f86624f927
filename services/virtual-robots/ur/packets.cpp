#include "services/virtual-robots/ur/packets.hpp"

#include "services/virtual-robots/ur/bytes.hpp"

namespace trb::virtual_robots::ur {
namespace {

constexpr std::uint8_t kRobotMessage = 20;

/** Sources of a message: the controller's interface and its real-time part. */
constexpr std::uint8_t kSourceInterface = 0xfe;
constexpr std::uint8_t kSourceRealTime = 0xfd;

enum class MessageKind : std::uint8_t { text = 0, version = 3, safety = 5, error = 6, key = 7, exception = 10 };

Bytes message(MessageKind kind, std::uint64_t time_us, std::uint8_t source = kSourceRealTime) {
  Bytes bytes;
  bytes.u8(kRobotMessage).u64(time_us).u8(source).u8(static_cast<std::uint8_t>(kind));
  return bytes;
}

}  // namespace

std::string version_packet() {
  constexpr std::string_view kProject = "URControl";
  Bytes bytes;
  bytes.u8(kRobotMessage)
      .u64(~std::uint64_t{0})
      .u8(kSourceInterface)
      .u8(static_cast<std::uint8_t>(MessageKind::version));
  bytes.u8(static_cast<std::uint8_t>(kProject.size())).text(kProject);
  // Major, minor, bug fix, build number, then the date up to the end.
  bytes.u8(5).u8(12).i32(0).i32(0).text("01-01-2022, 00:00:00");
  return bytes.with_length();
}

std::string text_packet(std::string_view text, std::uint64_t time_us) {
  return message(MessageKind::text, time_us).text(text).with_length();
}

std::string safety_packet(SafetyMode mode, std::uint64_t time_us) {
  Bytes bytes = message(MessageKind::safety, time_us);
  bytes.i32(0).i32(0).u8(static_cast<std::uint8_t>(mode)).u32(0).u32(0);
  return bytes.with_length();
}

std::string error_packet(std::int32_t code, std::int32_t argument, ErrorLevel level, std::string_view text,
                         std::uint64_t time_us) {
  Bytes bytes = message(MessageKind::error, time_us);
  bytes.i32(code).i32(argument).i32(static_cast<std::int32_t>(level)).u32(0).u32(0).text(text);
  return bytes.with_length();
}

std::string key_packet(std::string_view title, std::string_view text, std::uint64_t time_us) {
  Bytes bytes = message(MessageKind::key, time_us, kSourceInterface);
  bytes.i32(0).i32(0).u8(static_cast<std::uint8_t>(title.size())).text(title).text(text);
  return bytes.with_length();
}

std::string exception_packet(const ScriptError& error, std::uint64_t time_us) {
  return message(MessageKind::exception, time_us).i32(error.line).i32(error.column).text(error.text).with_length();
}

}  // namespace trb::virtual_robots::ur
