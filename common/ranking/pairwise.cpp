#include "common/ranking/pairwise.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace trb {
namespace {

/// T. L. Saaty, The Analytic Hierarchy Process, McGraw-Hill 1980, p. 21: the mean index of random matrices of n items.
constexpr double kRandomIndex[kMostJudged + 1] = {0,    0,    0,    0.58, 0.90, 1.12, 1.24, 1.32,
                                                  1.41, 1.45, 1.49, 1.51, 1.48, 1.56, 1.57, 1.59};
constexpr double kReciprocalTolerance = 0.01;

struct Pair {
  std::size_t i;
  std::size_t j;
};

/// The judgments of one node in logarithms: told(i, j) = -told(j, i).
class Table {
 public:
  explicit Table(std::size_t size) : size_(size), log_(size * size), weight_(size * size) {}

  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] bool known(std::size_t i, std::size_t j) const { return weight_[i * size_ + j] > 0; }
  [[nodiscard]] double log(std::size_t i, std::size_t j) const { return log_[i * size_ + j] / weight_[i * size_ + j]; }
  /// The pairs in the order and the direction in which they were first judged.
  [[nodiscard]] const std::vector<Pair>& pairs() const { return pairs_; }

  void add(std::size_t i, std::size_t j, double log, double weight) {
    if (!known(i, j)) pairs_.push_back({i, j});
    put(i, j, log, weight);
    put(j, i, -log, weight);
  }

 private:
  void put(std::size_t i, std::size_t j, double log, double weight) {
    log_[i * size_ + j] += weight * log;
    weight_[i * size_ + j] += weight;
  }

  std::size_t size_;
  std::vector<double> log_;
  std::vector<double> weight_;
  std::vector<Pair> pairs_;
};

std::string text_of(const Judgment& judgment) {
  return "'" + judgment.a + "' to '" + judgment.b + "' = " + short_number(judgment.times);
}

Error at_node(const std::string& node, Errc code, const std::string& what, std::string hint) {
  return fail(code, "judgments of '" + node + "': " + what, std::move(hint));
}

Result<std::size_t> index_of(const std::string& node, const std::vector<std::string>& items, const std::string& name) {
  const auto at = std::find(items.begin(), items.end(), name);
  if (at != items.end()) return static_cast<std::size_t>(at - items.begin());
  return at_node(node, Errc::unknown_key, "there is no '" + name + "' below it", "use one of " + quoted_names(items));
}

Status check_number(const std::string& node, const Judgment& judgment) {
  const double least = 1 / kGreatestJudgment;
  if (judgment.times >= least && judgment.times <= kGreatestJudgment) return Done{};  // false for NaN
  return at_node(node, Errc::bad_value, text_of(judgment) + " is no positive number up to 1e9",
                 "use 1 (alike) to 9 (extremely more), or 1/2 to 1/9 the other way round");
}

/// Done, if the pair is new to this person; else the judgment may only be the other direction of an earlier one.
Status check_repeated(const std::string& node, const Judgment& judgment, const Table& own, std::size_t i, std::size_t j,
                      const std::vector<bool>& told) {
  if (told[i * own.size() + j]) {
    return at_node(node, Errc::duplicate, "'" + judgment.a + "' to '" + judgment.b + "' is judged twice",
                   "keep one of the two");
  }
  if (!own.known(i, j) || std::abs(own.log(i, j) - std::log(judgment.times)) < kReciprocalTolerance) return Done{};
  return at_node(node, Errc::bad_value,
                 text_of(judgment) + ", but '" + judgment.b + "' to '" + judgment.a +
                     "' = " + short_number(std::exp(own.log(j, i))) + " is not its reciprocal",
                 "leave one of the two out, or write " + short_number(std::exp(own.log(i, j))));
}

Status add_opinion(const std::string& node, const std::vector<std::string>& items, const Opinion& opinion,
                   Table& table) {
  if (!(opinion.weight >= 1e-6 && opinion.weight <= 1e6)) {
    return at_node(node, Errc::bad_value, "a person counts " + short_number(opinion.weight),
                   "use a weight from 0.000001 to 1000000, or leave that person out");
  }
  Table own(items.size());
  std::vector<bool> told(items.size() * items.size());
  for (const Judgment& judgment : opinion.judgments) {
    const auto i = index_of(node, items, judgment.a);
    if (!i) return i.error();
    const auto j = index_of(node, items, judgment.b);
    if (!j) return j.error();
    if (*i == *j) {
      return at_node(node, Errc::bad_value, "'" + judgment.a + "' is compared with itself", "leave that out: it is 1");
    }
    if (auto good = check_number(node, judgment); !good) return good;
    if (auto good = check_repeated(node, judgment, own, *i, *j, told); !good) return good;
    told[*i * items.size() + *j] = true;
    if (own.known(*i, *j)) continue;
    own.add(*i, *j, std::log(judgment.times), 1);
    table.add(*i, *j, std::log(judgment.times), opinion.weight);
  }
  return Done{};
}

/// The group of each item: 0 for all if judgments link them all.
std::vector<std::size_t> groups_of(const Table& table) {
  const std::size_t none = table.size();
  std::vector<std::size_t> group(table.size(), none);
  std::size_t count = 0;
  for (std::size_t first = 0; first < table.size(); ++first) {
    if (group[first] != none) continue;
    std::vector<std::size_t> todo{first};
    group[first] = count;
    while (!todo.empty()) {
      const std::size_t i = todo.back();
      todo.pop_back();
      for (std::size_t j = 0; j < table.size(); ++j) {
        if (group[j] != none || !table.known(i, j)) continue;
        group[j] = count;
        todo.push_back(j);
      }
    }
    ++count;
  }
  return group;
}

Status check_linked(const std::string& node, const std::vector<std::string>& items, const Table& table) {
  const auto group = groups_of(table);
  const std::size_t last = *std::max_element(group.begin(), group.end());
  if (last == 0) return Done{};
  std::string what;
  for (std::size_t g = 0; g <= last; ++g) {
    std::vector<std::string> names;
    for (std::size_t i = 0; i < items.size(); ++i) {
      if (group[i] == g) names.push_back(items[i]);
    }
    what += (g == 0 ? "" : " | ") + quoted_names(names);
  }
  const auto other = static_cast<std::size_t>(std::find(group.begin(), group.end(), 1U) - group.begin());
  return at_node(node, Errc::missing, "nothing compares these groups with each other: " + what,
                 "compare one of each, for example '" + items[0] + "' with '" + items[other] + "'");
}

/// Logarithms of the weights that leave the least squares of the judgments' logarithms; of a full table they are the
/// rows' geometric means. Gauss on the Laplacian without its first row: positive definite, so no pivots are sought.
std::vector<double> least_squares(const Table& table) {
  const std::size_t n = table.size();
  std::vector<double> a(n * n);
  std::vector<double> b(n);
  for (std::size_t i = 1; i < n; ++i) {
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j || !table.known(i, j)) continue;
      a[i * n + i] += 1;
      a[i * n + j] -= 1;
      b[i] += table.log(i, j);
    }
  }
  for (std::size_t k = 1; k < n; ++k) {
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = a[i * n + k] / a[k * n + k];
      for (std::size_t j = k; j < n; ++j) a[i * n + j] -= factor * a[k * n + j];
      b[i] -= factor * b[k];
    }
  }
  std::vector<double> x(n);
  for (std::size_t i = n; i-- > 1;) {
    double sum = b[i];
    for (std::size_t j = i + 1; j < n; ++j) sum -= a[i * n + j] * x[j];
    x[i] = sum / a[i * n + i];
  }
  return x;
}

struct Principal {
  std::vector<double> log;  ///< of the eigenvector
  double value = 0;
  bool found = false;
};

/// Harker's matrix (missing judgments 0, their number added to the diagonal), scaled by a good guess of the weights:
/// what is left are deviations around 1, whatever the judgments' size.
std::vector<double> scaled_matrix(const Table& table, const std::vector<double>& guess) {
  const std::size_t n = table.size();
  std::vector<double> out(n * n);
  for (std::size_t i = 0; i < n; ++i) {
    out[i * n + i] = 1;
    for (std::size_t j = 0; j < n; ++j) {
      if (i == j) continue;
      if (table.known(i, j)) {
        out[i * n + j] = std::exp(table.log(i, j) - guess[i] + guess[j]);
      } else {
        out[i * n + i] += 1;
      }
    }
  }
  return out;
}

/// Power iteration. For any positive v the principal eigenvalue lies between the least and the greatest (Av)i / vi
/// (Collatz and Wielandt): it ends when these meet. Half of v is kept each time, or a circle of judgments would make it
/// oscillate.
Principal principal(const Table& table, const std::vector<double>& guess) {
  constexpr int kMostRounds = 20'000;
  constexpr double kMet = 1e-13;
  const std::size_t n = table.size();
  const std::vector<double> a = scaled_matrix(table, guess);
  std::vector<double> v(n, 1);
  std::vector<double> next(n);
  Principal out;
  for (int round = 0; round < kMostRounds && !out.found; ++round) {
    double least = HUGE_VAL;
    double greatest = 0;
    for (std::size_t i = 0; i < n; ++i) {
      next[i] = 0;
      for (std::size_t j = 0; j < n; ++j) next[i] += a[i * n + j] * v[j];
      least = std::min(least, next[i] / v[i]);
      greatest = std::max(greatest, next[i] / v[i]);
    }
    out.value = (least + greatest) / 2;
    out.found = greatest - least <= kMet * greatest;
    for (std::size_t i = 0; i < n; ++i) v[i] = (v[i] + next[i] / out.value) / 2;
    const double most = *std::max_element(v.begin(), v.end());
    for (double& one : v) one /= most;
  }
  out.log = guess;
  for (std::size_t i = 0; i < n; ++i) out.log[i] += std::log(v[i]);
  return out;
}

std::vector<double> weights_of(const std::vector<double>& logs) {
  const double most = *std::max_element(logs.begin(), logs.end());
  std::vector<double> out;
  double sum = 0;
  for (const double log : logs) {
    out.push_back(std::exp(log - most));
    sum += out.back();
  }
  for (double& weight : out) weight /= sum;
  return out;
}

Consistency consistency_of(std::size_t size, double lambda) {
  const auto n = static_cast<double>(size);
  Consistency out{n, 0, 0};
  if (size < 3) return out;
  const double index = (lambda - n) / (n - 1);
  if (index < 1e-10) return out;  // rounding: these judgments agree
  out.lambda_max = lambda;
  out.ci = index;
  out.cr = index / kRandomIndex[size];
  return out;
}

/// The one furthest from the weights. Among three items all are equally far: then the most extreme one is named.
void find_worst(const Table& table, const std::vector<std::string>& items, const std::vector<double>& logs,
                Priorities& out) {
  constexpr double kAlike = 1e-6;
  double most = 0;
  double boldest = 0;
  for (const Pair& pair : table.pairs()) {
    const double told = table.log(pair.i, pair.j);
    const double fits = logs[pair.i] - logs[pair.j];
    const double far = std::abs(told - fits);
    const bool bolder = far >= most - kAlike && std::abs(told) > boldest + kAlike;
    if (far < kAlike || (far <= most + kAlike && !bolder)) continue;
    most = far;
    boldest = std::abs(told);
    out.worst = Judgment{items[pair.i], items[pair.j], std::exp(told)};
    out.fits = std::exp(fits);
  }
}

}  // namespace

std::string short_number(double number) {
  char out[32];
  std::snprintf(out, sizeof out, "%.3g", number);
  return out;
}

std::string quoted_names(const std::vector<std::string>& names) {
  constexpr std::size_t kMost = 8;
  std::string out;
  for (std::size_t i = 0; i < names.size() && i < kMost; ++i) out += (i == 0 ? "'" : ", '") + names[i] + "'";
  return names.size() > kMost ? out + ", …" : out;
}

Result<Priorities> weigh(const std::string& node, const std::vector<std::string>& items,
                         const std::vector<Opinion>& opinions, WeightMethod method) {
  if (items.empty()) return at_node(node, Errc::missing, "there is nothing to weigh below it", "add what is compared");
  if (items.size() > kMostJudged) {
    return at_node(node, Errc::too_large, std::to_string(items.size()) + " things are more than judgments can weigh",
                   "group them: 15 at most below one criterion, or give measured values or weights");
  }
  Table table(items.size());
  for (const Opinion& opinion : opinions) {
    const auto added = add_opinion(node, items, opinion, table);
    if (added) continue;
    const std::string who = opinion.who.empty() ? "" : "'" + opinion.who + "': ";
    return fail(added.error().code, who + added.error().what, added.error().hint);
  }
  if (auto linked = check_linked(node, items, table); !linked) return linked.error();
  const std::vector<double> squares = least_squares(table);
  const Principal found = principal(table, squares);
  const std::vector<double>& logs = method == WeightMethod::eigenvector ? found.log : squares;
  Priorities out;
  out.weights = weights_of(logs);
  out.consistency = consistency_of(items.size(), found.value);
  find_worst(table, items, logs, out);
  if (found.found) return out;
  const std::string worst = out.worst ? "; most of all " + text_of(*out.worst) : "";
  return at_node(node, Errc::conflict, "they contradict each other so much that no weights follow" + worst,
                 "judge again: " + short_number(out.fits) + " would fit there");
}

}  // namespace trb
