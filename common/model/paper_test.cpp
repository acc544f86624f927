#include "common/model/paper.hpp"

#include <doctest/doctest.h>

#include <functional>
#include <limits>
#include <vector>

using namespace trb;
using namespace trb::model;

namespace {

/// Equation 12 as the paper prints its second line.
double second_line(const PaperParameters& p) {
  const auto n = static_cast<double>(p.n);
  return n * (n + 7) / 2 + static_cast<double>(p.k) + 2 * static_cast<double>(p.s + p.R_l + 2 * p.R_e + p.N_f) +
         static_cast<double>(5 * p.N_d + 9 * p.N_i) + p.delta_t * p.sum_x - static_cast<double>(p.sum_m);
}

}  // namespace

TEST_CASE("the paper's best case gives its 251 messages, term by term") {
  const PaperParameters best = paper_best_case();
  REQUIRE(check(best).ok());
  CHECK(boot(best) == 16);
  CHECK(identification(best) == 15);
  CHECK(devices(best) == 182);
  CHECK(start(best) == 213);
  CHECK(task(best) == 36);
  CHECK(forward(best) == 0);
  CHECK(sensor(best) == 2);
  CHECK(failures(best) == 0);
  CHECK(total(best) == 251);
}

TEST_CASE("the paper's worst case gives 299 by its own equation, two more than it prints") {
  const PaperParameters worst = paper_worst_case();
  REQUIRE(check(worst).ok());
  CHECK(total(worst) == 299);
  CHECK(forward(worst) == 8);
  PaperParameters without_fault = worst;
  without_fault.N_f = 0;
  CHECK(total(without_fault) == 297);
  PaperParameters local = worst;
  local.R_e = 0;
  local.R_l = 1;
  CHECK(total(local) == 297);
}

TEST_CASE("Figure 9's twelve tasks are forwarded seven times") {
  CHECK(forward({.n = 3, .N_d = 12, .k = 3, .sum_m = 7}) == 7);
}

TEST_CASE("ten fleets by hand: each term of Equation 12") {
  struct Case {
    PaperParameters p;
    double total;
  };
  const std::vector<Case> cases = {
      {{.n = 1, .N_d = 1}, 4 + 1 + 4},
      {{.n = 1, .N_i = 1}, 4 + 1 + 8},
      {{.n = 2, .N_d = 2}, 7 + 3 + 8 + 1},
      {{.n = 2, .N_d = 1, .N_i = 1}, 7 + 3 + 12 + 1},
      {{.n = 2, .N_d = 4, .k = 2, .sum_m = 4}, 7 + 3 + 16 + 1},
      {{.n = 3, .N_d = 3, .s = 2, .sum_x = 3, .delta_t = 10}, 10 + 6 + 4 + 30 + 12 + 2},
      {{.n = 3, .N_d = 3, .s = 1, .R_l = 2, .R_e = 3}, 10 + 6 + 2 + 12 + 2 + 4 + 12},
      {{.n = 4, .N_i = 5, .k = 1, .sum_m = 3, .N_f = 2}, 13 + 10 + 40 + 2 + 4},
      {{.n = 50, .N_d = 100}, 151 + 1275 + 400 + 99},
      {{.n = 10'000, .N_d = 100'000}, 30'001.0 + 50'005'000 + 400'000 + 99'999},
  };
  for (const Case& one : cases) {
    CAPTURE(one.p.n);
    CHECK(check(one.p).ok());
    CHECK(total(one.p) == one.total);
    CHECK(total(one.p) == second_line(one.p));
  }
}

TEST_CASE("what no fleet can be is refused by the variable's name, with a hint") {
  using Change = std::function<void(PaperParameters&)>;
  struct Case {
    const char* named;
    Change change;
  };
  const std::vector<Case> cases = {
      {"n (--robots)", [](auto& p) { p.n = 0; }},
      {"n (--robots)", [](auto& p) { p.n = kMaxRobots + 1; }},
      {"there is no task", [](auto& p) { p = {.n = 5}; }},
      {"N_i (--interpreted)", [](auto& p) { p.N_i = kMaxCount + 1; }},
      {"sum m_j (--block-tasks)", [](auto& p) { p.sum_m = 10; }},
      {"sum m_j (--block-tasks)", [](auto& p) { p.k = 5; }},
      {"k (--blocks)", [](auto& p) { p.k = 0; }},
      {"one robot does all 9 tasks", [](auto& p) { p.n = 1, p.k = 0, p.sum_m = 0; }},
      {"s (--sensors)", [](auto& p) { p.s = 0, p.sum_x = 0; }},
      {"s (--sensors)", [](auto& p) { p.s = 0, p.R_l = 0; }},
      {"R_e (--remote-requests)", [](auto& p) { p.n = 1, p.R_e = 1; }},
      {"N_f (--faulty)", [](auto& p) { p.N_f = 5; }},
      {"delta_t (--seconds)", [](auto& p) { p.delta_t = -1; }},
      {"delta_t (--seconds)", [](auto& p) { p.delta_t = 2e9; }},
      {"sum x_i (--rate)", [](auto& p) { p.sum_x = std::numeric_limits<double>::quiet_NaN(); }},
      {"over 1e15 updates", [](auto& p) { p.sum_x = 1e9, p.delta_t = 1e9; }},
  };
  for (const Case& one : cases) {
    CAPTURE(one.named);
    PaperParameters wrong = paper_best_case();
    one.change(wrong);
    const Status status = check(wrong);
    REQUIRE_FALSE(status.ok());
    CHECK_MESSAGE(status.error().what.find(one.named) != std::string::npos, status.error().what);
    CHECK_FALSE(status.error().hint.empty());
  }
}
