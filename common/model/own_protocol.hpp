// The number of messages of our own protocol between computers: what a run takes beside what time takes, term by term.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>

#include "common/base/result.hpp"
#include "common/model/checks.hpp"
#include "proto/phase.hpp"

namespace trb::model {

/// A fleet of robots' nodes and one cloud, each pair linked. Counts, but for `updates` and `seconds`.
struct OwnParameters {
  std::uint64_t robots = 1;           ///< n; n + 1 nodes, n (n + 1) / 2 links
  std::uint64_t tasks = 0;            ///< N
  std::uint64_t members = 0;          ///< M: robots that have work in the run
  std::uint64_t batons = 0;           ///< B: of who has work to who has, or decides, the first ones included
  std::uint64_t spells = 0;           ///< S: how often a robot comes under the run's control, and is let go 10 s later
  std::uint64_t kept = 0;             ///< K: batons that reach a robot while the run controls it
  std::uint64_t resumed = 0;          ///< G: tasks begun by such a robot, and not at the end of its task before
  std::uint64_t twice = 0;            ///< E: givers of a robot's first batons, beyond one, that come at the same moment
  std::uint64_t crossed = 0;          ///< D: pairs of nodes that have dialled each other at once
  std::uint64_t told = 0;             ///< L: profiles of robots that were connected after their node was linked
  std::uint64_t introduced = 0;       ///< J: lists of whom it reaches that a relay (the cloud) has told its peers
  std::uint64_t sensors = 0;          ///< P: plugged in or out
  std::uint64_t remote_requests = 0;  ///< R: conditions whose sensor is at another node
  std::uint64_t states = 0;  ///< V: changes of robots' values, told to all: once a second at most of each robot
  std::uint64_t faulty = 0;  ///< F: robots that break, with the policy to decide, their tasks taken over
  std::uint64_t bound = 0;   ///< Q: tasks that name no robot: the cloud decides when they are due
  std::uint64_t asked = 0;   ///< A: values that robots are asked for before such decisions
  std::uint64_t end_asked =
      0;               ///< W: how often a robot whose tasks are all done asks the cloud whether the run is over
  double updates = 0;  ///< x: of all watched sensors, 1/s
  double seconds = 0;  ///< T: how long the links are up, s
  bool operator==(const OwnParameters&) const = default;
};

/// What follows for a fleet. Errors: bad_value or too_large, naming the variable and `trb model`'s option.
Status check(const OwnParameters& parameters);

constexpr double kAsksEndAfter_s = 30;  ///< scheduler::Pace: then after twice that, and so on
constexpr double kAsksEndEach_s = 600;  ///< at most
constexpr double kKeepAlive_s = 2.5;    ///< router::Timing::keep_alive
constexpr double kBeacon_s = 5;         ///< router::Timing::beacon
constexpr double kControl_s = 10;       ///< a robot is let go so long after its last command's end

/// The functions expect parameters that have passed check(). Unit: messages.

/// 2 (n(n+1)/2 + D): each end of a link says who it is; so it does on a second connection, which is closed then.
double hellos(const OwnParameters& p);
/// (n + 1)(T / 5 + 3.3): four of each node in its first 0.9 s, then one in 5 s; a broadcast counts once. By time.
double beacons(const OwnParameters& p);
/// J: as links come up and end, those of 0.1 s together.
double introductions(const OwnParameters& p);
/// n (2 S + P + F) + L: each node tells each other one its profile when a run takes its robot, when it lets it go, for
/// a sensor, and for what is out of use.
double profiles(const OwnParameters& p);
/// N + 2 F: each task's result to the cloud; of a robot that breaks the failed one, and the one that it gives back.
double results(const OwnParameters& p);
/// 2 A: a robot's value, and its answer.
double values(const OwnParameters& p);
/// B + F + Q: from each actor to the next one; of a decision, to who takes over.
double batons(const OwnParameters& p);
/// M + E + F + Q: each robot at work asks who gives it its first baton for the run's definition; who takes over asks
/// for the decision.
double requests_for_definition(const OwnParameters& p);
/// M + E + F + Q: one for each request.
double definitions(const OwnParameters& p);
/// R.
double sensor_reads(const OwnParameters& p);
/// R + x T: answers, and values of watched sensors.
double sensor_readings(const OwnParameters& p);
/// n V: to every node.
double robot_states(const OwnParameters& p);
/// n F: to every node.
double faults(const OwnParameters& p);
/// F: the cloud takes the tasks back.
double releases(const OwnParameters& p);
/// M (F + Q): to every robot at work.
double decisions(const OwnParameters& p);

// Upkeep.

/// B + F + Q: one for each baton.
double batons_journaled(const OwnParameters& p);
/// N + 2 F: one for each result.
double results_journaled(const OwnParameters& p);
/// M (F + Q): one for each decision that was told.
double decisions_journaled(const OwnParameters& p);
/// 2 (N + F): each attempt at a task, when it is taken and when it runs.
double progress(const OwnParameters& p);
/// M: that the run is over, to each robot at work.
double ends(const OwnParameters& p);
/// W.
double requests_for_end(const OwnParameters& p);
/// F + W: one for each release, and one for each such question: it is not over.
double acknowledgements(const OwnParameters& p);
/// 2 D: each end closes the second connection. On a slow link fewer: one is closed before the other end has said a
/// word.
double goodbyes(const OwnParameters& p);
/// n (n + 1)(T / 2.5 - 1/2): each way of each link, every 2.5 s, the first one after 2.5 s. By time.
double keep_alives(const OwnParameters& p);
/// One over all that has gone one way of a link in 20 ms: over each keep-alive and Hello, and
/// L + J + n (P + 2 S + F + V) + B + K + G + 2 N + M - 1 + F (3 M + 4) + Q (2 M - 1) + A + 2 R + x T of the run. Two
/// that fall together are one: by time.
double seals(const OwnParameters& p);

/// A term: the messages of one subtype, whose phase phase_of() tells; "values" are words of the user's.
struct OwnTerm {
  std::string_view subtype;
  std::string_view formula;
  double (*value)(const OwnParameters&);
  bool by_time = false;  ///< depends on when the clock strikes: holds within 2 %, every other one exactly
};

/// All terms, phase by phase.
std::span<const OwnTerm> own_terms();
/// Of one phase; of `boot` nothing goes between computers.
double own_messages(CostPhase phase, const OwnParameters& p);
/// Of all phases.
double own_total(const OwnParameters& p);

}  // namespace trb::model
