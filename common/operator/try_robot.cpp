#include "common/operator/try_robot.hpp"

#include <algorithm>
#include <cstdio>
#include <memory>

#include "common/config/robot_auth.hpp"
#include "common/config/robot_tls.hpp"
#include "common/fleet/did_you_mean.hpp"
#include "common/operator/abort_run.hpp"
#include "common/operator/follow_run.hpp"
#include "common/operator/order_robots.hpp"
#include "common/operator/plan_run.hpp"
#include "common/operator/routes.hpp"
#include "common/operator/submit_run.hpp"
#include "common/operator/try_cures.hpp"
#include "common/scenario/parameters.hpp"

namespace trb::op {
namespace {

constexpr Duration kLookAgain = std::chrono::milliseconds(300);
constexpr Duration kFence = std::chrono::seconds(5);
constexpr Duration kControlEnds = std::chrono::seconds(12);  ///< a lease ends 10 s after its holder's last command
constexpr std::size_t kMostValues = 16;
constexpr double kSkillSlack_s = 20;  ///< for the run's way there and back, beyond the skill's own time
constexpr std::size_t kShown = 80;

std::string shown(const std::string& text) {
  return text.size() > kShown ? text.substr(0, kShown) + "..." : text;
}

/// "nan", "inf" or null among what a robot says are no measured numbers.
bool has_no_number(const std::string& data) {
  return std::ranges::any_of(std::vector{"nan", "NaN", "inf", "null"},
                             [&](const char* word) { return data.find(word) != std::string::npos; });
}

/// Neither commands.json nor a program on the robot knows the word.
bool has_no_words(Errc code) {
  return code == Errc::unknown_subtype || code == Errc::no_field_channel;
}

bool moves(const NodeProfile& profile) {
  const auto has = [&](const char* capability) {
    return std::ranges::find(profile.capabilities, capability) != profile.capabilities.end();
  };
  return has("mobile") || has("reach");
}

}  // namespace

Result<Value> parameter_value(const SkillInfo& skill, const ParameterInfo& parameter, const std::string& word) {
  if (parameter.type == "text" || parameter.type == "place") return Value{word};
  auto value = parse_json(word);
  const bool good = value && (parameter.type == "bool"      ? value->is_bool()
                              : parameter.type == "numbers" ? value->is_list()
                              : parameter.type == "integer" ? value->is_integer()
                                                            : value->is_number());
  if (good) return value;
  return fail(Errc::bad_value, skill.name + "." + parameter.name + ": '" + word + "' is no " + parameter.type,
              parameter.type == "numbers" ? "write it as [1,2,3]" : "give one");
}

namespace {

class Trial : public std::enable_shared_from_this<Trial> {
 public:
  Trial(Session& session, TryWish wish, Callback<std::vector<TryStep>> done)
      : session_(session), wish_(std::move(wish)), done_(std::move(done)) {}

  void begin() {
    until_ = session_.now().mono + wish_.connects;
    find();
  }

 private:
  void add(std::string name, TryState state, std::string text, std::string cure = {}) {
    if (state == TryState::failed) {
      if (text.find(kSignInRefused) != std::string::npos) cure = kSignInCure;
      if (text.find(kNotAllowed) != std::string::npos) cure = kNotAllowedCure;
      if (text.find(kTlsFailed) != std::string::npos) cure = kTlsCure;
    }
    steps_.push_back({std::move(name), state, std::move(text), std::move(cure)});
    if (wish_.person.see) wish_.person.see(steps_.back());
  }
  void end() { done_(std::move(steps_)); }

  // ---- there, connected, free

  void find() {
    request_routes(session_, on_success<RouteTable>(done_, [self = shared_from_this()](const RouteTable& table) {
                     self->on_table(table);
                   }));
  }

  void on_table(const RouteTable& table) {
    const auto at = std::ranges::find(table.routes, wish_.robot, &Route::id);
    const bool there = at != table.routes.end() && (at->state == "self" || is_reached(*at));
    const MonotonicTime now = session_.now().mono;
    const bool held = there && !at->profile.control.empty() && now < until_ + kControlEnds;
    if (there && at->profile.robot == "ONLINE" && !held) return on_connected(at->profile);
    if (held || now < until_) return session_.after(kLookAgain, [self = shared_from_this()] { self->find(); });
    if (!there) {
      const bool is_known = at != table.routes.end();
      const std::string near = is_known ? "" : nearest(wish_.robot, robots_of(table));
      add("there", TryState::failed, is_known ? "its node is " + at->state : "no node '" + wish_.robot + "' is known",
          near.empty() ? "on its computer: trb up NODE_DIR; why it is not reached: trb doctor " + wish_.robot
                       : "did you mean '" + near + "'?");
    } else {
      add("there", TryState::good, "its node is reached");
      const NodeProfile& profile = at->profile;
      const bool none = profile.framework.empty();
      add("connected", TryState::failed,
          none ? "it is no robot's node, or its mode-adapter is down" : profile.robot + ": " + profile.detail,
          none ? "node.json: framework, and mode-adapter in services"
               : cure_of_connection(profile) + "; what its node sees: trb doctor " + wish_.robot);
    }
    end();
  }

  /// Whether the robot has what was named. Errors: bad_value, with the nearest name.
  Status check_names() const {
    std::vector<std::string> skills;
    std::vector<std::string> parameters;
    for (const SkillInfo& skill : profile_.skills) {
      skills.push_back(skill.name);
      for (const ParameterInfo& parameter : skill.parameters) parameters.push_back(skill.name + "." + parameter.name);
    }
    const auto check = [&](const std::string& option, const std::vector<std::string>& named,
                           const std::vector<std::string>& known) -> Status {
      for (const std::string& one : named) {
        if (std::ranges::find(known, one) != known.end()) continue;
        return fail(Errc::bad_value, option + ": " + wish_.robot + " has no '" + one + "'",
                    did_you_mean(one, known, known.empty() ? "it has none" : "use one of"));
      }
      return Done{};
    };
    if (Status good = check("--skill", wish_.skills, skills); !good) return good;
    return check("--set", wish_.parameters, parameters);
  }

  void on_connected(const NodeProfile& profile) {
    profile_ = profile;
    if (const Status good = check_names(); !good) return done_(good.error());
    add("there", TryState::good, "its node is reached");
    add("connected", TryState::good,
        profile.framework + ", " + profile.mode + (profile.transport.empty() ? "" : " over " + profile.transport));
    if (profile.fenced) {
      add("free", TryState::failed, "it is stopped", "look why, then trb release " + wish_.robot);
      return end();
    }
    // Also this node: a skill is tried as a run, which is another holder.
    if (!profile.control.empty()) {
      add("free", TryState::failed, profile.control + " commands it", cure_of_control(profile));
      return end();
    }
    for (const OutOfUse& one : profile.out_of_use) {
      add("free", TryState::failed, one.text.empty() ? "it is out of use" : one.text,
          "put the robot right, then trb robot repaired (or return) " + wish_.robot);
      return end();
    }
    add("free", TryState::good, "nobody commands it, no fault stands");
    next_value(0);
  }

  // ---- state and position

  /// A sensor of the node's PC is the sensor-bus's, not the robot's.
  [[nodiscard]] bool is_plugged(const std::string& word) const {
    return std::ranges::any_of(profile_.plugged, [&](const SensorInfo& one) { return one.name == word; });
  }

  void next_value(std::size_t index) {
    while (index < profile_.sensors.size() && is_plugged(profile_.sensors[index])) ++index;
    if (index >= std::min(profile_.sensors.size(), kMostValues)) return position();
    ask(profile_.sensors[index],
        [self = shared_from_this(), index](const std::string& word, const Result<Message>& answer) {
          const bool only_told = !answer && has_no_words(answer.error().code);
          if (only_told) {
            self->add("state " + word, TryState::skipped, "told at each change; nobody can ask for it");
          } else {
            self->on_value("state " + word, word, answer);
          }
          self->next_value(index + 1);
        });
  }

  void position() {
    ask("position", [self = shared_from_this()](const std::string& word, const Result<Message>& answer) {
      const bool may_lack = !moves(self->profile_) && !answer;
      if (may_lack) {
        self->add(word, TryState::skipped, "it tells none, and needs none to stand where it is");
      } else {
        self->on_value(word, word, answer);
      }
      self->next_skill(0);
    });
  }

  void ask(const std::string& word, const std::function<void(const std::string&, const Result<Message>&)>& then) {
    session_.request(Send{.type = MessageType::request, .target = wish_.robot, .body = Opaque{word, {}}},
                     [word, then](const Result<Message>& answer) { then(word, answer); });
  }

  void on_value(const std::string& step, const std::string& word, const Result<Message>& answer) {
    if (!answer) {
      return add(step, TryState::failed, answer.error().text(),
                 cure_of_request(profile_, word, errc_name(answer.error().code)));
    }
    if (has_no_number(answer->data))
      return add(step, TryState::failed, "it says " + shown(answer->data), cure_of_request(profile_, word, ""));
    add(step, TryState::good, shown(answer->data));
  }

  // ---- skills

  void next_skill(std::size_t index) {
    if (index >= profile_.skills.size()) return stop();
    const SkillInfo& skill = profile_.skills[index];
    const bool is_named = std::ranges::find(wish_.skills, skill.name) != wish_.skills.end();
    if (!wish_.skills.empty() && !is_named) {
      add("skill " + skill.name, TryState::skipped, "not tried");
      return next_skill(index + 1);
    }
    wish_.person.may_try(skill, [self = shared_from_this(), index](bool yes) {
      if (yes) return self->fill(index, 0, {});
      self->add("skill " + self->profile_.skills[index].name, TryState::skipped, "not tried");
      self->next_skill(index + 1);
    });
  }

  /// The parameters that it needs, one after the other.
  void fill(std::size_t index, std::size_t which, Value::Object data) {
    const SkillInfo& skill = profile_.skills[index];
    while (which < skill.parameters.size() && !skill.parameters[which].required) ++which;
    if (which >= skill.parameters.size()) return run(index, std::move(data));
    const ParameterInfo& parameter = skill.parameters[which];
    wish_.person.value_of(skill, parameter, choices_of(parameter, profile_.places),
                          [self = shared_from_this(), index, which, data](const std::optional<std::string>& word) {
                            self->on_parameter(index, which, data, word);
                          });
  }

  void on_parameter(std::size_t index, std::size_t which, Value::Object data, const std::optional<std::string>& word) {
    const SkillInfo& skill = profile_.skills[index];
    const ParameterInfo& parameter = skill.parameters[which];
    const auto value =
        word ? parameter_value(skill, parameter, *word)
             : Result<Value>(fail(Errc::missing, "it needs '" + parameter.name + "' (" + parameter.type + ")"));
    if (!value) {
      add("skill " + skill.name, word || wish_.must ? TryState::failed : TryState::skipped, value.error().what,
          "give it: --set " + skill.name + "." + parameter.name + "=VALUE");
      return next_skill(index + 1);
    }
    data.emplace_back(parameter.name, *value);
    fill(index, which + 1, std::move(data));
  }

  /// As a run of one task: on the road, and with the end, that it has later.
  void run(std::size_t index, Value::Object data) {
    const SkillInfo& skill = profile_.skills[index];
    Scenario scenario;
    scenario.name = "try-" + skill.name;
    scenario.description = "trb robot try";
    Task task;
    task.id = "try";
    task.robot = wish_.robot;
    task.skill = skill.name;
    if (!data.empty()) task.data = dump_json(Value{std::move(data)});
    task.pinned = true;  // nobody else takes it over
    task.start_within_s = to_seconds(kFence);
    scenario.tasks = {task};
    plan_run(session_, scenario, "skill " + skill.name,
             step<RunPlan>(index, [this, index](RunPlan plan) { submit(index, std::move(plan)); }));
  }

  /// Continues with a value; an error fails the skill.
  template <class T>
  Callback<T> step(std::size_t index, std::function<void(T)> next) {
    return [self = shared_from_this(), index, next = std::move(next)](Result<T> result) {
      if (result) return next(std::move(*result));
      self->skill_failed(index, result.error().text());
    };
  }

  void skill_failed(std::size_t index, const std::string& why) {
    const std::string& name = profile_.skills[index].name;
    add("skill " + name, TryState::failed, why, cure_of_skill(profile_, name, why));
    next_skill(index + 1);
  }

  void submit(std::size_t index, RunPlan plan) {
    const ConfigFaults faults = faults_that_stop(plan.faults);
    if (!faults.empty()) return skill_failed(index, faults.front().key + ": " + faults.front().what);
    submit_run(session_, std::move(plan), {.expires_h = 0.1},
               step<std::string>(index, [this, index](const std::string& run) { follow(index, run); }));
  }

  void follow(std::size_t index, const std::string& run) {
    const double longest = std::max(1.0, profile_.skills[index].timeout_s) + kSkillSlack_s;
    follow_run(
        session_, {.run = run, .wait = seconds(longest), .until_paused = true},
        [](const RunView&, const RunView&) { return true; },
        step<RunView>(index, [this, index](const RunView& view) { on_view(index, view); }));
  }

  void on_view(std::size_t index, const RunView& view) {
    const std::string& name = profile_.skills[index].name;
    if (view.state != RunState::finished) {
      const std::string reason = view.tasks.empty() ? "" : view.tasks.front().reason;
      return give_up(index, view.run,
                     (reason.empty() ? std::string(name_of(view.state)) : reason) +
                         (view.waits_for.empty() ? "" : "; " + view.waits_for));
    }
    char took[32];
    std::snprintf(took, sizeof took, "FINISHED in %.1f s", view.tasks.front().duration_s);
    add("skill " + name, TryState::good, took);
    next_skill(index + 1);
  }

  /// The run is not left behind for somebody to find.
  void give_up(std::size_t index, const std::string& run, const std::string& why) {
    abort_run(session_, {run, "trb robot try: " + why, kFence},
              [self = shared_from_this(), index, why](const Result<RunView>&) { self->skill_failed(index, why); });
  }

  // ---- stop and release

  void stop() { order("stop", Stop{"trb robot try"}, true); }
  void release() { order("release", Release{"trb robot try"}, false); }

  void order(const std::string& name, const Body& body, bool fenced) {
    order_robots(session_, {wish_.robot}, body, kFence,
                 [self = shared_from_this(), name, fenced](const std::vector<RobotOrder>& rows) {
                   self->on_order(name, fenced, rows.front());
                 });
  }

  void on_order(const std::string& name, bool fenced, const RobotOrder& row) {
    if (row.state != "confirmed") {
      add(name, TryState::failed, row.state + ": " + row.text, cure_of_order(profile_, name));
      return fenced ? release() : end();
    }
    until_ = session_.now().mono + kFence;
    unproved_ = row.text;
    see_fence(name, fenced);
  }

  /// What the fleet is told of it.
  void see_fence(const std::string& name, bool fenced) {
    request_routes(session_, [self = shared_from_this(), name, fenced](const Result<RouteTable>& table) {
      self->on_fence(name, fenced, table);
    });
  }

  void on_fence(const std::string& name, bool fenced, const Result<RouteTable>& table) {
    const bool seen = table && std::ranges::any_of(table->routes, [&](const Route& route) {
                        return route.id == wish_.robot && route.profile.fenced == fenced;
                      });
    if (!seen && session_.now().mono < until_) {
      return session_.after(kLookAgain, [self = shared_from_this(), name, fenced] { self->see_fence(name, fenced); });
    }
    if (!seen) {
      add(name, TryState::failed, "confirmed, but the fleet is not told", "trb doctor " + wish_.robot);
    } else if (unproved_.empty()) {
      add(name, TryState::good, "confirmed by the robot, and the fleet knows");
    } else {
      add(name, TryState::unproved,
          unproved_ + (fenced ? ": try it while it moves" : "") + "; the fleet knows of the order");
    }
    if (fenced) return release();
    end();
  }

  Session& session_;
  TryWish wish_;
  Callback<std::vector<TryStep>> done_;
  MonotonicTime until_;
  NodeProfile profile_;
  std::vector<TryStep> steps_;
  std::string unproved_;  ///< RobotOrder::text of the last order, which was confirmed
};

}  // namespace

void try_robot(Session& session, TryWish wish, Callback<std::vector<TryStep>> done) {
  std::make_shared<Trial>(session, std::move(wish), std::move(done))->begin();
}

}  // namespace trb::op
