// A service in the event loop of a program that has one of its own: messages, deadlines, commits, its end.
#include "common/service/service.hpp"

#include <doctest/doctest.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <fstream>
#include <thread>

#include "common/security/keys.hpp"
#include "common/service/test/router_end.hpp"

using namespace trb;
using namespace trb::test;

namespace {

/// Acknowledges messages, and counts its deadlines.
class WavingCore final : public Core {
 public:
  void on_welcome(const NodeIdentity& node, Now now, Outbox&) override {
    node_ = node.id;
    next_ = now.mono + std::chrono::milliseconds(20);
  }
  void on(const Inbound& message, Now, Outbox& out) override {
    if (const Nack* nack = get_if<Nack>(&message.body)) return nacks_.push_back(*nack);
    ++waves_;
    if (journals) out.journal.push_back({waves_, may_wait});
    out.reply(message, Ack{"waved", ""});
  }
  void tick(Now now, Outbox&) override {
    if (!next_ || now.mono < *next_) return;
    next_.reset();
    ++ticks_;
  }
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const override { return next_; }

  [[nodiscard]] const std::string& node() const { return node_; }
  [[nodiscard]] int ticks() const { return ticks_; }
  [[nodiscard]] int waves() const { return waves_; }
  [[nodiscard]] const std::vector<Nack>& nacks() const { return nacks_; }

  bool journals = false;
  bool may_wait = false;  ///< what it journals

 private:
  std::string node_;
  std::optional<MonotonicTime> next_;
  int ticks_ = 0;
  int waves_ = 0;
  std::vector<Nack> nacks_;
};

Message wave(std::uint64_t id, std::size_t size = 0) {
  Message out;
  out.type = MessageType::command;
  out.subtype = "wave";
  out.source = out.target = "ant";
  out.id = id;
  out.data = Bytes(size, 'w');
  return out;
}

/// A foreign event loop: poll(2) on the service's one descriptor, at most until its deadline.
bool poll_once(Service& service) {
  const auto next = service.next_deadline();
  REQUIRE(next);  // a link always has a deadline
  const Duration left = std::max(Duration::zero(), *next - now().mono);
  pollfd item{service.descriptor(), POLLIN, 0};
  ::poll(&item, 1, static_cast<int>(std::chrono::ceil<std::chrono::milliseconds>(left).count()));
  return service.handle_ready();
}

const ServiceWelcome kWelcome{"ant", "robot", 1, 1, 1};

/// The service "probe" of a node, in this program's loop.
struct Served {
  explicit Served(int most_wait = kHighWaterMark) : router(most_wait) {
    init_crypto();
    std::ofstream("node.json") << R"({"id":"ant"})";
    auto opened = Service::open({.node_dir = folder.path, .name = "probe", .subtypes = {"wave"}, .own_log = false});
    REQUIRE(opened.ok());
    service = std::move(*opened);
  }
  bool poll() { return poll_once(*service); }
  bool in_time() const { return now().mono < end; }
  std::optional<Message> poll_until(std::string_view subtype) {
    std::optional<Message> message;
    while (in_time() && !(message && message->subtype == subtype)) {
      REQUIRE(poll());
      if (auto next = router.receive()) message = std::move(next);
    }
    return message;
  }
  /// It sends its hello and is welcomed; its core is notified.
  void start() {
    service->start(core);
    REQUIRE(poll_until(ServiceHello::kSubtype));
    router.say(kWelcome);
    while (core.node().empty() && in_time()) REQUIRE(poll());
  }
  void order_wave(std::uint64_t id) {
    REQUIRE(router.socket->send_to(router.peer, to_frame(encode_frame(wave(id)))) == SendResult::sent);
  }
  /// More than the kernel and libzmq hold between a router with a queue of one and the service, which is some 0.3 MB:
  /// many are with the service, which has not looked.
  void order_waves_that_wait() {
    for (std::uint64_t id = 1; id <= 64; ++id) {
      const Bytes bytes = encode_frame(wave(id, 16'384));
      while (router.socket->send_to(router.peer, to_frame(bytes)) != SendResult::sent) {
        REQUIRE(in_time());
        std::this_thread::yield();
      }
    }
  }
  /// One step with so many messages, for a router that does not read meanwhile.
  void send_waves(int count) {
    service->step([&](Now, Outbox& out) {
      for (int i = 0; i < count; ++i) out.command("bee", Opaque{"wave", std::to_string(i)});
    });
  }
  /// The router's next message. It answers the keep-alive, or the link would end; and the hello of a service that takes
  /// it for silent: a busy machine may let this program wait for longer than a lease.
  std::optional<Message> hear() {
    auto message = router.receive();
    if (message && message->subtype == ServiceAlive::kSubtype) router.say(ServiceAliveSeen{});
    if (message && message->subtype == ServiceHello::kSubtype) router.say(kWelcome);
    return message;
  }
  /// The router reads until so many have come: their data, in order.
  std::vector<std::string> read_waves(std::size_t count) {
    std::vector<std::string> read;
    while (read.size() < count && in_time()) {
      REQUIRE(poll());
      while (auto message = hear()) {
        if (message->subtype == "wave") read.push_back(message->data);
      }
    }
    return read;
  }
  void poll_to_end() {
    while (poll() && in_time()) {
    }
    CHECK(in_time());
  }

  Folder folder;
  Router router;
  WavingCore core;
  std::unique_ptr<Service> service;
  MonotonicTime end = now().mono + kPatience;
};

}  // namespace

TEST_CASE("a service runs in the event loop of a program that has one of its own") {
  Served served;
  served.start();
  CHECK(served.core.node() == "ant");
  // It answers messages, and its deadlines come.
  served.order_wave(77);
  const auto answer = served.poll_until(Ack::kSubtype);
  REQUIRE(answer);
  CHECK(answer->reply_to == 77);
  while (served.core.ticks() == 0 && served.in_time()) REQUIRE(served.poll());
  CHECK(served.core.ticks() == 1);
  // SIGTERM ends it.
  ::kill(::getpid(), SIGTERM);
  served.poll_to_end();
  CHECK(served.service->exit_status() == 0);
}

TEST_CASE("told to end, a service still does what it has to, until that is done") {
  Served served;
  bool is_done = false;
  int begun = 0;
  served.service->before_end([&](Now, Outbox&) { ++begun; }, [&] { return is_done; }, std::chrono::minutes(1));
  served.start();
  ::kill(::getpid(), SIGTERM);
  while (begun == 0 && served.in_time()) REQUIRE(served.poll());
  served.order_wave(77);
  REQUIRE(served.poll_until(Ack::kSubtype));
  is_done = true;
  served.poll_to_end();
  CHECK(begun == 1);
  CHECK(served.service->exit_status() == 0);
}

TEST_CASE("told to end, however often, a service waits no longer than it may") {
  Served served;
  int begun = 0;
  served.service->before_end([&](Now, Outbox&) { ++begun; }, [] { return false; }, std::chrono::milliseconds(100));
  served.start();
  const MonotonicTime told = now().mono;
  ::kill(::getpid(), SIGTERM);
  while (begun == 0 && served.in_time()) REQUIRE(served.poll());
  ::kill(::getpid(), SIGTERM);
  served.poll_to_end();
  CHECK(now().mono - told >= std::chrono::milliseconds(100));
  CHECK(begun == 1);
}

TEST_CASE("every service answers what it has counted, without its core") {
  Served served;
  served.start();
  Message greeting = wave(76);
  greeting.subtype = RunQuery::kSubtype;  // that body is malformed
  greeting.data = "\xc1";
  REQUIRE(served.router.socket->send_to(served.router.peer, to_frame(encode_frame(greeting))) == SendResult::sent);
  for (const Body& question : {Body{ServiceCountersRequest{"probe"}}, Body{AdapterCountersRequest{}}}) {
    Message request = wave(77);
    request.type = MessageType::request;
    request.subtype = subtype_of(question);
    request.data = encode_body(question);
    REQUIRE(served.router.socket->send_to(served.router.peer, to_frame(encode_frame(request))) == SendResult::sent);
    const auto answer = served.poll_until(Counters::kSubtype);
    REQUIRE(answer);
    CHECK(answer->reply_to == 77);
    const auto counters = decode<Counters>(answer->data);
    REQUIRE(counters);
    CHECK(counters->node == "ant");
    CHECK(counters->service == "probe");
    REQUIRE(counters->values.size() == 1);
    CHECK(counters->values[0].name == "refused.malformed_body");
    CHECK(counters->values[0].value == 1);
  }
  CHECK(served.core.waves() == 0);
}

TEST_CASE("a burst of one step comes whole and in order to a router that reads later") {
  Served served;
  served.start();
  served.send_waves(6000);
  CHECK_FALSE(served.service->has_room());
  std::vector<std::string> expected;
  for (int i = 0; i < 6000; ++i) expected.push_back(std::to_string(i));
  CHECK(served.read_waves(6000) == expected);
  while (!served.service->has_room() && served.in_time()) REQUIRE(served.poll());
  CHECK(served.service->has_room());
  CHECK(served.core.nacks().empty());
}

TEST_CASE("what finds no room on the bus is counted as that, and the core is told") {
  Served served;
  served.start();
  served.send_waves(20'000);
  while (served.core.nacks().empty() && served.in_time()) REQUIRE(served.poll());
  REQUIRE_FALSE(served.core.nacks().empty());
  CHECK(served.core.nacks().size() <= 64);
  CHECK(served.core.nacks()[0].code == "queue_full");
  CHECK(served.core.nacks()[0].subtype == "wave");
  CHECK(served.core.nacks()[0].target == "bee");
}

TEST_CASE("a service whose commits take long looks at its deadlines after some of what waits") {
  Served served(1);
  served.core.journals = true;
  served.service->on_journal([&](const std::vector<Journal>&) {
    const MonotonicTime over = now().mono + std::chrono::milliseconds(7);
    while (now().mono < over) {
    }
    return Status(Done{});
  });
  served.start();
  served.order_waves_that_wait();
  REQUIRE(served.poll());
  // The commits alone take 50 ms with the eighth.
  CHECK(served.core.waves() > 0);
  CHECK(served.core.waves() <= 8);
}

TEST_CASE("behind a commit that failed a service receives, journals and sends nothing, though more waits for it") {
  {
    // More does wait: with a commit that succeeds one look takes many.
    Served good(1);
    good.start();
    good.order_waves_that_wait();
    REQUIRE(good.poll());
    CHECK(good.core.waves() > 10);
  }
  Served served(1);
  served.core.journals = true;
  int commits = 0;
  served.service->on_journal([&](const std::vector<Journal>&) {
    ++commits;
    return commits == 1 ? Status(fail(Errc::io_error, "the disk is full")) : Status(Done{});
  });
  served.start();
  // The second one would find what the first has changed in the core.
  served.order_waves_that_wait();
  served.poll_to_end();
  CHECK(served.service->exit_status() == 74);
  CHECK(commits == 1);
  CHECK(served.core.waves() == 1);
  while (const auto message = served.router.receive()) CHECK(message->subtype != Ack::kSubtype);
}

TEST_CASE("a record that may wait is committed with the next one that may not, and at the end of the service") {
  Served served;
  std::vector<std::vector<int>> commits;
  served.service->on_journal([&](const std::vector<Journal>& records) {
    commits.emplace_back();
    for (const Journal& one : records) commits.back().push_back(std::any_cast<int>(one.record));
    return Status(Done{});
  });
  served.core.journals = true;
  served.start();
  for (const bool may_wait : {true, true, false, true}) {
    served.core.may_wait = may_wait;
    served.order_wave(77);
    REQUIRE(served.poll_until(Ack::kSubtype));  // what is sent does not wait for it
  }
  CHECK(commits == std::vector<std::vector<int>>{{1, 2, 3}});
  ::kill(::getpid(), SIGTERM);
  served.poll_to_end();
  CHECK(served.service->exit_status() == 0);
  CHECK(commits == std::vector<std::vector<int>>{{1, 2, 3}, {4}});
}

TEST_CASE("a service whose last records cannot be committed does not end as if they were") {
  Served served;
  served.service->on_journal(
      [](const std::vector<Journal>&) { return Status(fail(Errc::io_error, "the disk is full")); });
  served.core.journals = served.core.may_wait = true;
  served.start();
  served.order_wave(77);
  REQUIRE(served.poll_until(Ack::kSubtype));
  ::kill(::getpid(), SIGTERM);
  served.poll_to_end();
  CHECK(served.service->exit_status() == 74);
}
