#include "services/cli/commands/drive.hpp"

#include <algorithm>
#include <cmath>

#include "common/base/number_text.hpp"
#include "common/drivers/text/number_text.hpp"
#include "common/operator/drive_robot.hpp"
#include "services/cli/io/person.hpp"
#include "services/cli/io/print.hpp"
#include "services/cli/io/probe.hpp"

namespace trb::cli {
namespace {

constexpr double kShortest_s = 0.1;
constexpr double kLongest_s = 3600;

Result<std::vector<double>> read_speeds(std::string_view text) {
  std::vector<double> speeds;
  while (true) {
    const std::string_view word = text.substr(0, text.find(','));
    const auto speed = parse_number<double>(word);
    if (!speed || !std::isfinite(*speed)) {
      return fail(Errc::bad_value, "--speeds: '" + std::string(word.substr(0, 40)) + "' is no number",
                  "give m/s and rad/s with commas between them, in the order of the part's axes: --speeds 0.2,0");
    }
    speeds.push_back(*speed);
    if (speeds.size() > kMaxDriveAxes) {
      return fail(Errc::bad_value, "--speeds: more than " + std::to_string(kMaxDriveAxes), "give one for each axis");
    }
    if (word.size() == text.size()) return speeds;
    text.remove_prefix(word.size() + 1);
  }
}

Result<op::DriveWish> wish_of(const Arguments& arguments) {
  op::DriveWish wish;
  wish.robot = arguments.words[0];
  if (!arguments.has("--speeds")) {
    return fail(Errc::missing, "--speeds: how fast?", "trb drive " + wish.robot + " --speeds 0.2,0");
  }
  auto speeds = read_speeds(arguments.get("--speeds"));
  if (!speeds) return speeds.error();
  wish.speeds = std::move(*speeds);
  const auto lasts = arguments.number("--for", 2);
  if (!lasts) return lasts.error();
  if (*lasts < kShortest_s || *lasts > kLongest_s) {
    return fail(Errc::bad_value, "--for: " + arguments.get("--for") + " s", "give from 0.1 to 3600 seconds");
  }
  wish.lasts = seconds(*lasts);
  wish.take = arguments.has("--take");
  wish.by = person_of(arguments);
  if (!arguments.has("--part")) return wish;
  constexpr auto kParts = enum_names(DrivePart{});
  const auto* const part = std::find(kParts.begin(), kParts.end(), arguments.get("--part"));
  if (part == kParts.end()) {
    return fail(Errc::bad_value, "--part: '" + arguments.get("--part") + "'", "use base, joints, tool or belt");
  }
  wish.part = static_cast<DrivePart>(part - kParts.begin());
  return wish;
}

/// The first part that the robot says can be driven; without one, its node refuses the drive and says why.
DrivePart first_part(Probe& probe, const std::string& robot) {
  const auto table = probe.routes();
  if (!table) return {};
  for (const Route& route : table->routes) {
    if (route.id == robot && !route.profile.drives.empty()) return route.profile.drives.front().part;
  }
  return {};
}

double at_share(const std::vector<double>& sorted, double share) {
  if (sorted.empty()) return 0;
  return sorted[std::min(sorted.size() - 1, static_cast<std::size_t>(share * static_cast<double>(sorted.size())))];
}

double rounded(double ms) {
  return std::round(ms * 100) / 100;
}

void print_report(const Arguments& arguments, const op::DriveWish& wish, const op::DriveReport& report) {
  std::vector<double> sorted = report.round_trips;
  std::sort(sorted.begin(), sorted.end());
  const double median = rounded(at_share(sorted, 0.5));
  const double p99 = rounded(at_share(sorted, 0.99));
  const double most = rounded(sorted.empty() ? 0 : sorted.back());
  const std::string part(name_of(wish.part));
  if (arguments.has("--json")) {
    Value::List all;
    for (const double ms : report.round_trips) all.push_back(Value{rounded(ms)});
    return print_json(Value{Value::Object{
        {"robot", Value{wish.robot}},
        {"part", Value{part}},
        {"sent", Value{static_cast<std::int64_t>(report.sent)}},
        {"answered", Value{static_cast<std::int64_t>(sorted.size())}},
        {"round_trip_ms", Value{Value::Object{{"median", Value{median}}, {"p99", Value{p99}}, {"max", Value{most}}}}},
        {"round_trips_ms", Value{std::move(all)}}}});
  }
  print_line(wish.robot + ": drove its " + part + " for " + drivers::number_text(to_seconds(wish.lasts)) +
             " s and let go; " + std::to_string(sorted.size()) + " of " + std::to_string(report.sent) +
             " messages answered; there and back " + drivers::number_text(median) + " ms (median), " +
             drivers::number_text(p99) + " ms (99 %), " + drivers::number_text(most) + " ms at most");
}

}  // namespace

int run_drive(const Arguments& arguments) {
  auto wish = wish_of(arguments);
  if (!wish) {
    print_error(arguments, wish.error());
    return kWrongUse;
  }
  auto probe = open_probe(arguments);
  if (!probe) return kFailed;
  if (!arguments.has("--part")) wish->part = first_part(*probe, wish->robot);
  const auto report = probe->wait<op::DriveReport>(
      [&](op::Session& session, const auto& done) { op::drive_robot(session, *wish, done); });
  if (!report) return print_error(arguments, probe->with_nearest(report.error(), wish->robot));
  print_report(arguments, *wish, *report);
  return kGood;
}

}  // namespace trb::cli
