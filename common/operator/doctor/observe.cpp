#include "common/operator/doctor/observe.hpp"

#include <algorithm>
#include <memory>

#include "common/operator/routes.hpp"

namespace trb::op {
namespace {

constexpr Duration kEchoWait = std::chrono::seconds(2);
constexpr std::size_t kSmallEcho = 32;
constexpr std::size_t kLargeEcho = 16'000;
constexpr std::size_t kMostProbes = 64;  ///< a fleet of hundreds is asked peer by peer

bool is_asked(const Observed& seen, const Route& route) {
  return seen.asked.empty() || route.id == seen.asked || route.address == seen.asked;
}

/// Five requests; `next` is called when all are answered or timed out.
struct RouterQuestions {
  Observed seen;
  ObservedNext next;
  int open = 5;

  template <class Answer>
  static Callback<Answer> into(const std::shared_ptr<RouterQuestions>& all, Answer Observed::*field) {
    return [all, field](Result<Answer> answer) {
      if (answer) all->seen.*field = std::move(*answer);
      all->answered();
    };
  }
  void answered() {
    if (--open == 0) next(std::move(seen));
  }
};

class Echoes : public std::enable_shared_from_this<Echoes> {
 public:
  Echoes(Session& session, Observed seen, ObservedNext next)
      : session_(session), seen_(std::move(seen)), next_(std::move(next)) {
    for (const Route& route : seen_.routes.routes) {
      if (route.state == "ONLINE" && is_asked(seen_, route) && peers_.size() < kMostProbes) peers_.push_back(route);
    }
  }

  void next_peer() {
    if (at_ == peers_.size()) {
      return session_.after(Duration::zero(), [self = shared_from_this()] { self->next_(std::move(self->seen_)); });
    }
    seen_.echoes.push_back({peers_[at_].id, false, false});
    send(kSmallEcho, &EchoProbe::small);
  }

 private:
  void send(std::size_t size, bool EchoProbe::*field) {
    const EchoRequest question{{std::string(size, 'e')}};
    const auto take = [self = shared_from_this(), pad = question.pad, field](const Result<Message>& answer) {
      const auto echo = answer ? decode<Echo>(answer->data) : Result<Echo>(answer.error());
      self->seen_.echoes.back().*field = echo && echo->pad == pad;
      self->go_on(field == &EchoProbe::small);
    };
    session_.request(Send{.type = MessageType::request, .target = peers_[at_].id, .body = question}, take, kEchoWait);
  }

  void go_on(bool was_small) {
    if (was_small && seen_.echoes.back().small && !loses_large(peers_[at_].address))
      return send(kLargeEcho, &EchoProbe::large);
    ++at_;
    next_peer();
  }

  [[nodiscard]] bool loses_large(const std::string& address) const {
    return std::ranges::any_of(seen_.addresses, [&](const AddressProbe& at) {
      return at.address == address && at.large == LargeDatagram::lost;
    });
  }

  Session& session_;
  Observed seen_;
  const ObservedNext next_;
  std::vector<Route> peers_;
  std::size_t at_ = 0;
};

}  // namespace

void observe_router(Session& session, Observed seen, const ObservedNext& next) {
  const auto all = std::make_shared<RouterQuestions>(RouterQuestions{std::move(seen), next});
  all->seen.answers = true;
  request_routes(session, RouterQuestions::into(all, &Observed::routes));
  session.ask_node<ServiceTable>(ServiceListRequest{}, RouterQuestions::into(all, &Observed::services));
  session.ask_node<RunTable>(RunListRequest{}, [all](Result<RunTable> answer) {
    if (answer)
      all->seen.runs = std::move(*answer);
    else
      all->seen.no_runs = answer.error();
    all->answered();
  });
  session.ask_node<Counters>(ServiceCountersRequest{"scheduler"}, RouterQuestions::into(all, &Observed::scheduler));
  session.ask_node<LinkErrorTable>(LinkErrorTableRequest{}, RouterQuestions::into(all, &Observed::errors));
}

void observe_links(Session& session, Observed seen, const ObservedNext& next) {
  std::make_shared<Echoes>(session, std::move(seen), next)->next_peer();
}

std::vector<AddressProbe> addresses_to_try(const Observed& seen, const std::vector<std::string>& seeds,
                                           const std::function<bool(const std::string&)>& in_own_subnet) {
  std::vector<AddressProbe> out;
  const auto add = [&](const std::string& address, bool seed) {
    const auto known = std::ranges::find(out, address, &AddressProbe::address);
    if (known != out.end()) {
      known->seed = known->seed || seed;
    } else if (!address.empty() && out.size() < kMostProbes) {
      out.push_back({address, seed, in_own_subnet(address)});
    }
  };
  for (const Route& route : seen.routes.routes) {
    if (route.state == "self" || !is_asked(seen, route)) continue;
    add(route.address, false);
    // The link itself shows that a router is there.
    if (route.state == "ONLINE" && route.via.empty() && !out.empty() && out.back().address == route.address)
      out.back().port = Port::zmtp;
  }
  for (const std::string& seed : seeds) add(seed, true);
  if (seen.asked.find(':') != std::string::npos) add(seen.asked, false);
  return out;
}

}  // namespace trb::op
