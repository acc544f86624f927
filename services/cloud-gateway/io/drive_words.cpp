#include "services/cloud-gateway/io/drive_words.hpp"

#include "common/base/ids.hpp"
#include "services/cloud-gateway/io/api/members.hpp"
#include "services/cloud-gateway/io/json_text.hpp"

namespace trb::gateway {
namespace {

constexpr std::int64_t kMostSequence = (1LL << 53U) - 1;

Result<std::string> robot_in(const Members& members, std::string_view name) {
  auto robot = members.text(name, kMaxIdSize);
  if (!robot) return robot.error();
  if (const Status valid = check_id(name, *robot); !valid) return valid.error();
  return robot;
}

}  // namespace

Result<DriveWord> read_drive_word(const Value& word) {
  const auto members = Members::of(word, {"drive", "part", "speeds", "sequence", "take"});
  if (!members) return members.error();
  auto robot = robot_in(*members, "drive");
  if (!robot) return robot.error();
  const auto part = members->one_of<DrivePart>("part");
  if (!part) return part.error();
  auto speeds = members->numbers("speeds", kMaxDriveAxes);
  if (!speeds) return speeds.error();
  const auto sequence = members->number_or("sequence", 0, 1, kMostSequence);
  if (!sequence) return sequence.error();
  if (*sequence == 0) return fail(Errc::missing, "sequence: is missing", "begin with 1, and count on");
  const auto take = members->flag_or("take", false);
  if (!take) return take.error();
  return DriveWord{std::move(*robot), *part, std::move(*speeds), static_cast<std::uint64_t>(*sequence), *take};
}

Result<std::string> read_robot_word(const Value& word, std::string_view name) {
  const auto members = Members::of(word, {name});
  if (!members) return members.error();
  return robot_in(*members, name);
}

std::string json_drive_answer(const DriveAnswer& answer) {
  JsonObject out;
  out.text("robot", answer.robot).number("sequence", answer.sequence);
  out.text("state", answer.is_over ? "over" : "driving");
  out.raw("round_trip_s", dump_json(Value{answer.round_trip_s}));
  if (answer.error) out.raw("error", *problem_reply(*answer.error).body);
  return JsonObject().raw("drive", out.done()).done();
}

}  // namespace trb::gateway
