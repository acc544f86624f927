// Stop and release, broken connections, and skills.
#include "common/transport/loop.hpp"
#include "services/cli/conform/cases.hpp"

namespace trb::cli::conform {
namespace {

constexpr Duration kOrderMoment = std::chrono::milliseconds(200);

std::string data_of(const Play& play) {
  return play.words().numeric() ? "9 9 9" : "to be thrown away";
}

void stop_and_release(Play& play) {
  play.order(play.words().stop());
  play.expect_stopped();
  play.order(play.words().release());
  play.expect_released();
}

void stop(Play& play) {
  stop_and_release(play);
  play.expect_quiet(kOrderMoment, "one answer to each order");
  play.still_understands();
}

void stop_twice(Play& play) {
  play.order(play.words().stop());
  play.order(play.words().stop());
  play.expect_stopped();
  play.expect_stopped();
  play.order(play.words().release());
  play.expect_released();
  play.still_understands();
}

void stop_in_message(Play& play) {
  for (const std::size_t fields : {1U, 2U, 3U, 4U}) {
    play.send_part("request", play.settings().echo, data_of(play), fields);
    stop_and_release(play);
    play.still_understands();
  }
}

/// The order overtakes the acknowledgement that it crosses.
void stop_crosses_ok(Play& play) {
  const auto fields = play.fields("request", play.settings().echo, data_of(play));
  if (fields.empty()) return;
  play.raw(fields[0]);
  stop_and_release(play);
  play.expect_quiet(kOrderMoment, "no acknowledgement after the confirmation of a stop");
  play.still_understands();
}

void broken_field(Play& play) {
  if (play.delayed()) return play.not_tried("a pause ends a field");
  const auto fields = play.fields("request", play.settings().echo, data_of(play));
  if (fields.empty()) return;
  play.send_part("request", play.settings().echo, data_of(play), 2);
  play.raw(fields[4].substr(0, fields[4].size() / 2));
  play.break_off();
  play.still_understands();
}

void broken_message(Play& play) {
  play.send_part("request", play.settings().echo, data_of(play), 4);
  play.break_off();
  play.still_understands();
}

bool has_skill(Play& play) {
  if (!play.settings().skill.empty()) return true;
  play.not_tried("the robot is made to move only with --run 'SKILL DATA'");
  return false;
}

void begin_skill(Play& play) {
  play.send("command", play.settings().skill, play.settings().skill_data);
}

void done(Play& play) {
  if (!has_skill(play)) return;
  begin_skill(play);
  const MonotonicTime began = read_clocks().mono;
  const std::string report = play.report(play.settings().skill_timeout);
  play.skill_took = read_clocks().mono - began;
  if (report.rfind("done", 0) == 0) return;
  play.wrong("information done of " + play.settings().skill + ", within its timeout_s",
             report.empty() ? "nothing" : report);
}

void no_done(Play& play, const std::string& when) {
  const Duration patience = play.skill_took == Duration{} ? 5 * kOrderMoment : play.skill_took + kOrderMoment;
  const std::string report = play.report(patience);
  if (report.rfind("done", 0) == 0) play.wrong("no 'done' of " + play.settings().skill + " " + when, report);
}

void stop_ends_skill(Play& play) {
  if (!has_skill(play)) return;
  begin_skill(play);
  play.order(play.words().stop());
  play.expect_stopped();
  no_done(play, "that was stopped");
  play.order(play.words().release());
  play.expect_released();
  play.still_understands();
}

void stopped_refuses(Play& play) {
  if (!has_skill(play)) return;
  play.order(play.words().stop());
  play.expect_stopped();
  begin_skill(play);
  no_done(play, "between stop and release");
  play.order(play.words().release());
  play.expect_released();
  play.still_understands();
}

}  // namespace

std::vector<Case> order_cases() {
  return {
      {"stop", "a stop and a release are confirmed", "Stop", stop},
      {"stop-twice", "a stop received twice is answered twice", "Stop", stop_twice},
      {"stop-in-message", "a stop between two fields throws away what is held of the message", "Stop", stop_in_message},
      {"stop-crosses-ok", "nothing is acknowledged after the confirmation of a stop", "Stop", stop_crosses_ok},
      {"broken-field", "the connection breaks in the middle of a field; a new one begins anew", "A new connection",
       broken_field},
      {"broken-message", "the connection breaks between two fields; a new one begins anew", "A new connection",
       broken_message},
      {"done", "the end of a skill is reported", "What the robot reports to its own node", done},
      {"stop-ends-skill", "a skill that was stopped is not reported as done", "Stop", stop_ends_skill},
      {"stopped-refuses", "between stop and release no command is carried out", "Stop", stopped_refuses},
  };
}

}  // namespace trb::cli::conform
