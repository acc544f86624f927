#include "common/model/own_protocol.hpp"

#include <algorithm>
#include <array>
#include <string>

namespace trb::model {
namespace {

constexpr double kFirstBeacons = 3.3;  ///< four in 0.9 s, and half of one: the next may be due or not

double count_of(std::uint64_t count) {
  return static_cast<double>(count);
}

double pairs(const OwnParameters& p) {
  return count_of(p.robots) * (count_of(p.robots) + 1) / 2;
}

void check_sizes(const OwnParameters& p, Checks& checks) {
  checks.require(p.robots >= 1, Errc::bad_value, "n (--robots): there is no robot", "use at least 1");
  checks.at_most(p.robots, kMaxRobots, "n (--robots)");
  checks.counts({{p.tasks, "N (--tasks)"},
                 {p.batons, "B (--batons)"},
                 {p.spells, "S (--spells)"},
                 {p.crossed, "D (--crossed)"},
                 {p.told, "L (--told)"},
                 {p.introduced, "J (--introduced)"},
                 {p.sensors, "P (--sensors)"},
                 {p.remote_requests, "R (--remote-requests)"},
                 {p.states, "V (--states)"},
                 {p.asked, "A (--asked)"},
                 {p.end_asked, "W (--end-asked)"}});
  checks.updates(p.updates, "x (--rate)", p.seconds, "T (--seconds)", "x T (--rate, --seconds)");
}

void check_run(const OwnParameters& p, Checks& checks) {
  const std::string tasks = std::to_string(p.tasks) + " tasks";
  const auto at_most = [&](std::uint64_t count, std::uint64_t most, const std::string& name, const std::string& of) {
    checks.require(count <= most, Errc::bad_value, name + ": " + std::to_string(count) + " of " + of,
                   "use at most " + std::to_string(most));
  };
  at_most(p.members, std::min(p.robots, p.tasks), "M (--members)", std::to_string(p.robots) + " robots with " + tasks);
  at_most(p.spells, p.tasks, "S (--spells)", tasks);
  at_most(p.kept, p.batons, "K (--kept)", std::to_string(p.batons) + " batons");
  at_most(p.twice, p.batons, "E (--twice)", std::to_string(p.batons) + " batons");
  at_most(p.resumed, p.tasks, "G (--resumed)", tasks);
  checks.require(p.faulty < p.robots || p.robots == 0, Errc::bad_value,
                 "F (--faulty): " + std::to_string(p.faulty) + " of " + std::to_string(p.robots) + " robots fail",
                 "use at most n - 1: one has to take over");
  checks.require(p.faulty == 0 || p.tasks > 0, Errc::bad_value, "F (--faulty): there is no task to take over",
                 "use --tasks");
  checks.require(p.faulty + p.bound > 0 || p.asked == 0, Errc::bad_value,
                 "A (--asked): nobody is asked if no robot fails and every task names its robot",
                 "use --faulty or --bound");
  at_most(p.bound, p.tasks, "Q (--bound)", tasks);
  at_most(p.crossed, static_cast<std::uint64_t>(std::min(pairs(p), 1e18)), "D (--crossed)",
          "the pairs of " + std::to_string(p.robots + 1) + " nodes");
  checks.require(p.members > 0 || p.end_asked == 0, Errc::bad_value,
                 "W (--end-asked): no robot has work in the run, and so none asks for its end", "use --members");
  checks.require(p.tasks > 0, Errc::bad_value, "N (--tasks): there is no task", "use at least 1");
  checks.require(p.members > 0, Errc::bad_value, "M (--members): no robot has work in the run, which has " + tasks,
                 "use at least 1");
}

constexpr std::array kTerms{
    OwnTerm{"hello", "n(n + 1) + 2D", hellos},
    OwnTerm{"beacon", "(n + 1)(T / 5 + 3.3)", beacons, true},
    OwnTerm{"neighbours", "J", introductions},
    OwnTerm{"node_profile", "n(2S + P + F) + L", profiles},
    OwnTerm{"results", "N + 2F", results},
    OwnTerm{"values", "2A", values},
    OwnTerm{"baton", "B + F + Q", batons},
    OwnTerm{"need_definition", "M + E + F + Q", requests_for_definition},
    OwnTerm{"definition", "M + E + F + Q", definitions},
    OwnTerm{"sensor_read", "R", sensor_reads},
    OwnTerm{"sensor_reading", "R + x T", sensor_readings, true},
    OwnTerm{"robot_state", "n V", robot_states},
    OwnTerm{"robot_fault", "n F", faults},
    OwnTerm{"release_tasks", "F", releases},
    OwnTerm{"run_decision", "M(F + Q)", decisions},
    OwnTerm{"baton_journaled", "B + F + Q", batons_journaled},
    OwnTerm{"results_journaled", "N + 2F", results_journaled},
    OwnTerm{"decision_journaled", "M(F + Q)", decisions_journaled},
    OwnTerm{"task_progress", "2(N + F)", progress},
    OwnTerm{"run_over", "M", ends},
    OwnTerm{"need_end", "W", requests_for_end},
    OwnTerm{"ack", "F + W", acknowledgements},
    OwnTerm{"goodbye", "2D", goodbyes},
    OwnTerm{"keep_alive", "n(n + 1)(T / 2.5 - 1/2)", keep_alives, true},
    OwnTerm{"seal",
            "keep_alive + hello + L + J + n(P + 2S + F + V) + B + K + G + 2N + M - 1 + F(3M + 4) + Q(2M - 1) + A + 2W "
            "+ 2R + x T",
            seals, true},
};

}  // namespace

Status check(const OwnParameters& p) {
  Checks checks;
  check_sizes(p, checks);
  check_run(p, checks);
  return checks.status();
}

double hellos(const OwnParameters& p) {
  return 2 * (pairs(p) + count_of(p.crossed));
}

double beacons(const OwnParameters& p) {
  return p.seconds > 0 ? (count_of(p.robots) + 1) * (p.seconds / kBeacon_s + kFirstBeacons) : 0;
}

double introductions(const OwnParameters& p) {
  return count_of(p.introduced);
}

double profiles(const OwnParameters& p) {
  return count_of(p.robots) * count_of(2 * p.spells + p.sensors + p.faulty) + count_of(p.told);
}

double results(const OwnParameters& p) {
  return count_of(p.tasks + 2 * p.faulty);
}

double values(const OwnParameters& p) {
  return count_of(2 * p.asked);
}

double batons(const OwnParameters& p) {
  return count_of(p.batons + p.faulty + p.bound);
}

double requests_for_definition(const OwnParameters& p) {
  return count_of(p.members + p.twice + p.faulty + p.bound);
}

double definitions(const OwnParameters& p) {
  return requests_for_definition(p);
}

double sensor_reads(const OwnParameters& p) {
  return count_of(p.remote_requests);
}

double sensor_readings(const OwnParameters& p) {
  return count_of(p.remote_requests) + p.updates * p.seconds;
}

double robot_states(const OwnParameters& p) {
  return count_of(p.robots) * count_of(p.states);
}

double faults(const OwnParameters& p) {
  return count_of(p.robots) * count_of(p.faulty);
}

double releases(const OwnParameters& p) {
  return count_of(p.faulty);
}

double decisions(const OwnParameters& p) {
  return count_of(p.members) * count_of(p.faulty + p.bound);
}

double batons_journaled(const OwnParameters& p) {
  return batons(p);
}

double results_journaled(const OwnParameters& p) {
  return results(p);
}

double decisions_journaled(const OwnParameters& p) {
  return decisions(p);
}

double progress(const OwnParameters& p) {
  return count_of(2 * (p.tasks + p.faulty));
}

double ends(const OwnParameters& p) {
  return count_of(p.members);
}

double requests_for_end(const OwnParameters& p) {
  return count_of(p.end_asked);
}

double acknowledgements(const OwnParameters& p) {
  return releases(p) + requests_for_end(p);
}

double goodbyes(const OwnParameters& p) {
  return count_of(2 * p.crossed);
}

double keep_alives(const OwnParameters& p) {
  return 2 * pairs(p) * std::max(0.0, p.seconds / kKeepAlive_s - 0.5);
}

double seals(const OwnParameters& p) {
  const double last = p.members > 0 ? -1 : 0;  // the last actor hears of the end with its result's acknowledgement
  const double run = count_of(p.batons + p.kept + p.resumed + 2 * p.tasks + p.members) + last;
  const double told =
      count_of(p.told + p.introduced) + count_of(p.robots) * count_of(p.sensors + 2 * p.spells + p.faulty + p.states);
  const double decided = count_of(p.faulty) * (3 * count_of(p.members) + 4) +
                         count_of(p.bound) * (2 * count_of(p.members) - 1) + count_of(p.asked);
  const double sensors = count_of(2 * p.remote_requests) + p.updates * p.seconds;
  return keep_alives(p) + hellos(p) + told + run + decided + 2 * requests_for_end(p) + sensors;
}

std::span<const OwnTerm> own_terms() {
  return kTerms;
}

double own_messages(CostPhase phase, const OwnParameters& p) {
  double out = 0;
  for (const OwnTerm& term : kTerms) out += phase_of(term.subtype) == phase ? term.value(p) : 0;
  return out;
}

double own_total(const OwnParameters& p) {
  double out = 0;
  for (const OwnTerm& term : kTerms) out += term.value(p);
  return out;
}

}  // namespace trb::model
