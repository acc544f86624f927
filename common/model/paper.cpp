#include "common/model/paper.hpp"

#include <string>

#include "common/model/checks.hpp"

namespace trb::model {
namespace {

double real(std::uint64_t count) {
  return static_cast<double>(count);
}

void check_sizes(const PaperParameters& p, Checks& checks) {
  checks.require(p.n >= 1, Errc::bad_value, "n (--robots): there is no robot", "use at least 1");
  checks.at_most(p.n, kMaxRobots, "n (--robots)");
  checks.counts({{p.N_d, "N_d (--direct)"}, {p.N_i, "N_i (--interpreted)"}, {p.k, "k (--blocks)"}});
  checks.at_most(p.sum_m, 2 * kMaxCount, "sum m_j (--block-tasks)");
  checks.counts({{p.s, "s (--sensors)"}, {p.R_l, "R_l (--local-requests)"}, {p.R_e, "R_e (--remote-requests)"}});
  checks.updates(p.sum_x, "sum x_i (--rate)", p.delta_t, "delta_t (--seconds)", "delta_t sum x_i (--seconds, --rate)");
}

void check_blocks(const PaperParameters& p, Checks& checks) {
  const std::uint64_t of = p.N_d + p.N_i;
  const std::string counted = std::to_string(of) + " tasks";
  checks.require(of >= 1, Errc::bad_value, "N_d + N_i (--direct, --interpreted): there is no task", "use at least 1");
  checks.require(p.sum_m <= of, Errc::bad_value,
                 "sum m_j (--block-tasks): " + std::to_string(p.sum_m) + " of " + counted, "use at most that many");
  checks.require(p.sum_m >= 2 * p.k, Errc::bad_value,
                 "sum m_j (--block-tasks): a block has at least two tasks, and " + std::to_string(p.k) +
                     " blocks have " + std::to_string(p.sum_m),
                 "use at least " + std::to_string(2 * p.k) + ", or fewer --blocks");
  checks.require(p.k > 0 || p.sum_m == 0, Errc::bad_value,
                 "k (--blocks): " + std::to_string(p.sum_m) + " tasks are in no block", "use at least 1");
  const bool alone = p.n == 1 && of > 1;
  checks.require(!alone || (p.k == 1 && p.sum_m == of), Errc::bad_value, "k (--blocks): one robot does all " + counted,
                 "use --blocks 1 --block-tasks " + std::to_string(of));
}

}  // namespace

Status check(const PaperParameters& p) {
  Checks checks;
  check_sizes(p, checks);
  check_blocks(p, checks);
  checks.require(p.s > 0 || p.R_l + p.R_e == 0, Errc::bad_value,
                 "s (--sensors): there is no sensor to send a request to", "use at least 1");
  checks.require(p.s > 0 || p.sum_x == 0, Errc::bad_value, "s (--sensors): there is no sensor that sends updates",
                 "use at least 1, or --rate 0");
  checks.require(p.n > 1 || p.R_e == 0, Errc::bad_value, "R_e (--remote-requests): there is no other robot",
                 "use --local-requests, or more --robots");
  checks.require(p.N_f < p.n || p.n == 0, Errc::bad_value,
                 "N_f (--faulty): " + std::to_string(p.N_f) + " of " + std::to_string(p.n) + " robots fail",
                 "use at most n - 1: one has to take over");
  return checks.status();
}

double boot(const PaperParameters& p) {
  return 3 * real(p.n) + 1;
}

double identification(const PaperParameters& p) {
  return real(p.n) * (real(p.n) + 1) / 2;
}

double devices(const PaperParameters& p) {
  return 2 * real(p.s) + p.delta_t * p.sum_x;
}

double start(const PaperParameters& p) {
  return boot(p) + identification(p) + devices(p);
}

std::uint64_t tasks(const PaperParameters& p) {
  return p.N_d + p.N_i;
}

double task(const PaperParameters& p) {
  return 4 * real(p.N_d) + 8 * real(p.N_i);
}

double forward(const PaperParameters& p) {
  return real(tasks(p)) - real(p.sum_m) + real(p.k) - 1;
}

double scenario(const PaperParameters& p) {
  return task(p) + forward(p);
}

double sensor(const PaperParameters& p) {
  return 2 * real(p.R_l) + 4 * real(p.R_e);
}

double failures(const PaperParameters& p) {
  return 2 * real(p.N_f);
}

double total(const PaperParameters& p) {
  return start(p) + scenario(p) + sensor(p) + failures(p);
}

PaperParameters paper_best_case() {
  return {.n = 5, .N_d = 9, .k = 1, .sum_m = 9, .s = 1, .sum_x = 1, .delta_t = 180, .R_l = 1};
}

PaperParameters paper_worst_case() {
  return {.n = 5, .N_i = 9, .s = 1, .sum_x = 1, .delta_t = 180, .R_e = 1, .N_f = 1};
}

}  // namespace trb::model
