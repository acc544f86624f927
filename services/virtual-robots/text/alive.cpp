#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include "services/virtual-robots/support/text.hpp"
#include "services/virtual-robots/text/dialogue.hpp"

namespace trb::virtual_robots::text {
namespace {

constexpr double kSpeed = 0.5;  ///< m/s

struct Point {
  double x = 0;
  double y = 0;
};

class Alive : public Dialogue {
 public:
  explicit Alive(double silence) : silence_(silence) {}

  std::optional<std::string> take(std::string& input) const override { return take_line(input, end()); }
  std::string_view end() const override { return "\n"; }

  std::string answer(std::uint64_t, const std::string& request, double now) override {
    heard_at_ = now;
    std::string_view words = request;
    const std::string_view order = take_word(words);
    if (order == "PING") return "PONG";
    if (order == "POSE") return "POSE " + text_of(at(now));
    if (order == "STATE") return std::string("STATE ") + (silent_ ? "silent" : driving_ ? "driving" : "idle");
    if (order == "STOP") {
      stop(now, "stopped");
      return "OK";
    }
    if (order == "RESUME") {
      silent_ = false;
      return "OK";
    }
    return order == "GOTO" ? go(words, now) : "ERROR unknown";
  }
  std::vector<std::string> advance(double now) override {
    if (driving_ && now >= heard_at_ + silence_) {
      silent_ = true;
      stop(now, "silence");
    }
    if (driving_ && now >= arrives_at_) {
      from_ = to_;
      driving_ = false;
      said_.push_back("ARRIVED " + text_of(to_));
    }
    return std::exchange(said_, {});
  }
  std::optional<double> next_deadline() const override {
    if (!driving_) return std::nullopt;
    return std::min(arrives_at_, heard_at_ + silence_);
  }
  void fail(double now) override { stop(now, "fault"); }
  void clear() override {}

 private:
  std::string go(std::string_view words, double now) {
    const auto x = parse_number(take_word(words));
    const auto y = parse_number(words);
    if (!x || !y) return "ERROR numbers";
    if (silent_) return "ERROR silence";
    from_ = at(now);
    to_ = {*x, *y};
    begin_ = now;
    arrives_at_ = now + std::hypot(to_.x - from_.x, to_.y - from_.y) / kSpeed;
    driving_ = true;
    return "OK";
  }
  void stop(double now, const std::string& why) {
    if (!driving_) return;
    from_ = at(now);
    driving_ = false;
    said_.push_back("LOST " + why);
  }
  Point at(double now) const {
    if (!driving_ || arrives_at_ <= begin_) return from_;
    const double part = std::min(1.0, (now - begin_) / (arrives_at_ - begin_));
    return {from_.x + part * (to_.x - from_.x), from_.y + part * (to_.y - from_.y)};
  }
  static std::string text_of(const Point& point) { return format_fixed(point.x, 3) + " " + format_fixed(point.y, 3); }

  double silence_;
  double heard_at_ = 0;
  Point from_;
  Point to_;
  double begin_ = 0;
  double arrives_at_ = 0;
  bool driving_ = false;
  bool silent_ = false;  ///< it has stopped for silence, and waits for RESUME
  std::vector<std::string> said_;
};

}  // namespace

std::optional<std::string> take_line(std::string& input, std::string_view end) {
  const std::size_t at = input.find(end);
  if (at == std::string::npos) return std::nullopt;
  std::string line = input.substr(0, at);
  input.erase(0, at + end.size());
  return line;
}

std::unique_ptr<Dialogue> make_alive(double silence) {
  return std::make_unique<Alive>(silence);
}

}  // namespace trb::virtual_robots::text
