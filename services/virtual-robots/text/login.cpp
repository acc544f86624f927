#include <set>

#include "services/virtual-robots/support/text.hpp"
#include "services/virtual-robots/text/dialogue.hpp"

namespace trb::virtual_robots::text {
namespace {

constexpr double kProgram_s = 3;  ///< how long a program runs

// What a refusal names.
constexpr const char* kNoDollar = "10";
constexpr const char* kWrongCommand = "11";  ///< also: no login
constexpr const char* kBadPassword = "13";
constexpr const char* kNotReady = "20";

class Login : public Dialogue {
 public:
  explicit Login(std::string password) : password_(std::move(password)) {}

  std::optional<std::string> take(std::string& input) const override { return take_line(input, end()); }
  std::string_view end() const override { return "\r\n"; }

  std::string answer(std::uint64_t client, const std::string& request, double now) override {
    if (!request.starts_with('$')) return "!" + request + "," + kNoDollar;
    const std::size_t comma = std::min(request.find(','), request.size());
    const std::string name = request.substr(1, comma - 1);
    const std::string parameter = comma == request.size() ? "" : request.substr(comma + 1);
    const std::string refused = refusal(client, name, parameter, now);
    if (!refused.empty()) return "!" + name + "," + refused;
    return "#" + name + "," + (name == "GetStatus" ? status(now) : "0");
  }
  void fail(double) override {
    error_ = true;
    ends_at_ = 0;
  }
  void clear() override { error_ = false; }

 private:
  /** Carries the command out; the code of its refusal, or nothing. */
  std::string refusal(std::uint64_t client, const std::string& name, const std::string& parameter, double now) {
    if (name == "Login") {
      if (parameter != password_) return kBadPassword;
      known_.insert(client);
    } else if (!known_.contains(client)) {
      return kWrongCommand;
    } else if (name == "Start") {
      if (error_ || now < ends_at_) return kNotReady;
      ends_at_ = now + kProgram_s;
    } else if (name == "Stop") {
      ends_at_ = 0;
    } else if (name == "Reset") {
      error_ = false;
    } else if (name != "GetStatus") {
      return kWrongCommand;
    }
    return {};
  }
  /** Ten flags (teach, auto, warning, serious error, safeguard, emergency stop, error, paused, running, ready), and the
   * error's number. */
  std::string status(double now) const {
    const bool running = now < ends_at_;
    const std::string flags = std::string("010000") + (error_ ? "1" : "0") + "0" + (running ? "1" : "0");
    return flags + (running || error_ ? "0" : "1") + (error_ ? ",9000" : ",0000");
  }

  std::string password_;
  std::set<std::uint64_t> known_;  ///< clients that have given the password
  double ends_at_ = 0;             ///< of the program
  bool error_ = false;
};

}  // namespace

std::unique_ptr<Dialogue> make_login(std::string password) {
  return std::make_unique<Login>(std::move(password));
}

}  // namespace trb::virtual_robots::text
