// The bus link against a router's end played by the test: hello, welcome, restarts, refusals.
#include <doctest/doctest.h>
#include <poll.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <limits>
#include <set>
#include <thread>

#include "common/base/test/temporary_folder.hpp"
#include "common/security/keys.hpp"
#include "common/service/bus_link.hpp"
#include "common/service/service.hpp"
#include "common/transport/loop.hpp"

using namespace trb;

namespace {

constexpr Duration kPatience = std::chrono::seconds(60);

/// A temporary folder, which becomes the working directory: sockets are bus/NAME.ipc.
struct Folder : TemporaryFolder {
  Folder() {
    std::filesystem::create_directory(path + "/bus");
    std::filesystem::current_path(path);
  }
  ~Folder() { std::filesystem::current_path("/"); }
};

/// The router's end of one service's socket.
struct Router {
  Context context;
  std::unique_ptr<Socket> socket;
  Bytes peer;

  /// `most` messages wait here, the others with the service.
  explicit Router(int most = kHighWaterMark) {
    socket = std::make_unique<Socket>(*Socket::bus_server(context, ""));
    REQUIRE(zmq_setsockopt(socket->handle(), ZMQ_SNDHWM, &most, sizeof most) == 0);
    REQUIRE(socket->bind("ipc://bus/probe.ipc").ok());
  }

  std::optional<Message> receive() {
    Frame id;
    Frame frame;
    if (!socket->receive(id) || !socket->receive(frame)) return std::nullopt;
    peer = view_of(id);
    auto header = decode_frame(view_of(frame));
    REQUIRE(header.ok());
    return to_message(*header);
  }
  void say(const Body& body) {
    Message message;
    message.type = MessageType::information;
    message.subtype = subtype_of(body);
    message.source = message.target = "ant";
    message.data = encode_body(body);
    CHECK(socket->send_to(peer, to_frame(encode_frame(message))) == SendResult::sent);
  }
};

/// Advances time on the link, in steps of 20 ms without waiting, until the router's end has received one of the
/// subtypes.
std::optional<Message> hear(BusLink& link, Router& router, const std::set<std::string_view>& subtypes) {
  const MonotonicTime end = read_clocks().mono + kPatience;
  for (Now now = read_clocks(); now.mono < end; now = read_clocks()) {
    link.tick(now);
    link.receive(now);
    zmq::pollitem_t items[] = {{router.socket->handle(), 0, ZMQ_POLLIN, 0}, {link.handle(), 0, ZMQ_POLLIN, 0}};
    zmq::poll(items, 2, std::chrono::milliseconds(20));
    if (auto message = router.receive(); message && subtypes.count(message->subtype) != 0) return message;
  }
  return std::nullopt;
}

std::optional<Message> hear(BusLink& link, Router& router, std::string_view subtype) {
  return hear(link, router, std::set{subtype});
}

template <class Condition>
bool link_until(BusLink& link, Condition condition) {
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (!condition() && read_clocks().mono < end) {
    zmq::pollitem_t item{link.handle(), 0, ZMQ_POLLIN, 0};
    zmq::poll(&item, 1, std::chrono::milliseconds(20));
    link.receive(read_clocks());
  }
  return condition();
}

ServiceHello hello() {
  return {"cli", {"wave"}, 7, 1, "test"};
}

/// A service's link and its router's end of it.
struct Ends {
  Folder folder;
  Router router;
  Context context;
  BusLink link{context, ipc_bus("probe"), hello()};

  void welcome() {
    REQUIRE(hear(link, router, ServiceHello::kSubtype));
    router.say(ServiceWelcome{"ant", "robot", 1, 1, 1});
    REQUIRE(link_until(link, [&] { return link.up(); }));
  }
};

/// Acknowledges messages, and counts its deadlines.
class WavingCore final : public Core {
 public:
  void on_welcome(const NodeIdentity& node, Now now, Outbox&) override {
    node_ = node.id;
    next_ = now.mono + std::chrono::milliseconds(20);
  }
  void on(const Inbound& message, Now, Outbox& out) override {
    ++waves_;
    if (journals) out.record(waves_);
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

  bool journals = false;

 private:
  std::string node_;
  std::optional<MonotonicTime> next_;
  int ticks_ = 0;
  int waves_ = 0;
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
    router.say(ServiceWelcome{"ant", "robot", 1, 1, 1});
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

TEST_CASE("a service says hello until it is welcomed, then its messages bear its slot") {
  init_crypto();
  Ends ends;
  CHECK(ends.link.send(Send{.target = "ant", .body = Stop{}}).value() == 0);
  const auto first = hear(ends.link, ends.router, ServiceHello::kSubtype);
  REQUIRE(first);
  CHECK(decode<ServiceHello>(first->data)->subtypes == std::vector<std::string>{"wave"});
  ends.router.say(ServiceWelcome{"ant", "robot", 0x1234, 1, 1});
  REQUIRE(link_until(ends.link, [&] { return ends.link.up(); }));
  const std::uint64_t id =
      ends.link.send(Send{.type = MessageType::command, .target = "bee", .body = Stop{"x"}}).value();
  CHECK((id >> 48U) == 0x1234);
  const auto heard = hear(ends.link, ends.router, Stop::kSubtype);
  REQUIRE(heard);
  CHECK(heard->source == "ant");
  CHECK(heard->target == "bee");
  CHECK(heard->id == id);
}

TEST_CASE("of large messages for a router that stands still a few megabytes wait, small ones still have room") {
  init_crypto();
  Ends ends;
  ends.welcome();
  Message picture;
  picture.type = MessageType::information;
  picture.subtype = "picture";
  picture.target = "bee";
  picture.data = Bytes(1'000'000, 'p');
  int sent = 0;
  while (sent < 2 * kHighWaterMark && ends.link.send(picture).value() != 0) ++sent;
  // The router's own end has received some as well.
  CHECK(sent < kReceiveHighWaterMark + 16);
  CHECK(ends.link.send(Send{.type = MessageType::command, .target = "bee", .body = Stop{"x"}}).value() != 0);
}

TEST_CASE("what its hearer would have to refuse does not leave, and the maker is told") {
  init_crypto();
  Ends ends;
  ends.welcome();
  const auto refused = [&](Body body, const std::string& target = "bee") {
    return ends.link.send(Send{.type = MessageType::command, .target = target, .body = std::move(body)}).error();
  };
  RobotState state;
  state.values.resize(33);
  CHECK(refused(state).code == Errc::too_large);
  CHECK(refused(state).what == "robot_state: values: list over 32 items");
  SensorImage image;
  image.bytes.bytes.resize(1'000'001);
  CHECK(refused(image).what == "sensor_image: bytes: over 1000000 bytes");
  CHECK(refused(Opaque{"picture", std::string(kMaxDataSize + 1, 'x')}).code == Errc::too_large);
  SensorReading reading;
  reading.number = std::numeric_limits<double>::quiet_NaN();
  CHECK(refused(reading).code == Errc::bad_value);
  CHECK(refused(Stop{}, std::string(65, 'b')).code == Errc::malformed);
  // The largest message that may be sent arrives.
  REQUIRE(ends.link.send(Send{.target = "bee", .body = Opaque{"picture", std::string(kMaxDataSize, 'x')}}).value() !=
          0);
  const auto heard = hear(ends.link, ends.router, "picture");
  REQUIRE(heard);
  CHECK(heard->data.size() == kMaxDataSize);
}

TEST_CASE("ids bear the slot and a count, and cannot be guessed") {
  init_crypto();
  MessageIds ids;
  std::set<std::uint64_t> random;
  std::uint64_t all = 0;
  for (std::uint64_t count = 1; count <= 3000; ++count) {
    const std::uint64_t id = ids.next(0x1234);
    CHECK((id >> 48U) == 0x1234);
    CHECK((id & 0xffffU) == count);
    const std::uint64_t middle = id >> 16U & 0xffff'ffffU;
    random.insert(middle);
    all |= middle;
  }
  CHECK(random.size() > 2990);
  CHECK(all == 0xffff'ffffU);
  for (std::uint64_t count = 3001; count <= 0x1'0002; ++count) CHECK((ids.next(1) & 0xffffU) == (count & 0xffffU));
}

TEST_CASE("a router that was started again is told hello again") {
  init_crypto();
  Folder folder;
  Context context;
  BusLink link(context, ipc_bus("probe"), hello());
  {
    Router router;
    REQUIRE(hear(link, router, ServiceHello::kSubtype));
    router.say(ServiceWelcome{"ant", "robot", 1, 1, 1});
    REQUIRE(link_until(link, [&] { return link.up(); }));
  }
  std::filesystem::remove(folder.path + "/bus/probe.ipc");
  Router again;
  // Once its lease has ended, it says hello unasked.
  const auto first = hear(link, again, {ServiceAlive::kSubtype, ServiceHello::kSubtype});
  REQUIRE(first);
  if (first->subtype == ServiceAlive::kSubtype) {
    again.say(HelloWanted{});
    REQUIRE(hear(link, again, ServiceHello::kSubtype));
  }
  again.say(ServiceWelcome{"ant", "robot", 2, 2, 2});
  REQUIRE(link_until(link, [&] { return link.up(); }));
  CHECK(link.welcome()->slot == 2);
}

TEST_CASE("a link by which something far too large came is made again") {
  init_crypto();
  Ends ends;
  ends.welcome();
  const Bytes first = ends.router.peer;
  REQUIRE(ends.router.socket->send_to(ends.router.peer, to_frame(Bytes(2U << 20U, 'x'))) == SendResult::sent);
  // Its libzmq closes the connection and never reopens it: the service notices when its lease ends.
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (ends.router.peer == first && read_clocks().mono < end) {
    ends.link.tick(read_clocks());
    (void)ends.link.receive(read_clocks());
    (void)ends.router.receive();
  }
  REQUIRE(ends.router.peer != first);
  ends.router.say(ServiceWelcome{"ant", "robot", 2, 1, 1});
  REQUIRE(link_until(ends.link, [&] { return ends.link.up() && ends.link.welcome()->slot == 2; }));
}

TEST_CASE("an answer that comes before the router's welcome goes to the one who waits: it refuses no service") {
  init_crypto();
  Ends ends;
  REQUIRE(hear(ends.link, ends.router, ServiceHello::kSubtype));
  ends.router.say(Nack{"peer_unreachable", "task_offer", "bee", "no link", ""});
  std::optional<Message> got;
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (!got && read_clocks().mono < end) got = ends.link.receive(read_clocks());
  REQUIRE(got);
  CHECK(got->subtype == "nack");
  CHECK(ends.link.refusal().empty());
}

TEST_CASE("a refusal is kept for the person, an answer goes to the one who waits") {
  init_crypto();
  Ends ends;
  REQUIRE(hear(ends.link, ends.router, ServiceHello::kSubtype));
  ends.router.say(Nack{"already_claimed", "service_hello", "ant", "service 'cli' is running already", ""});
  REQUIRE(link_until(ends.link, [&] { return !ends.link.refusal().empty(); }));
  CHECK(ends.link.refusal().find("already_claimed") == 0);
  ends.router.say(ServiceWelcome{"ant", "robot", 1, 1, 1});
  REQUIRE(link_until(ends.link, [&] { return ends.link.up(); }));
  CHECK(ends.link.refusal().empty());
  ends.router.say(Ack{"stopped", ""});
  std::optional<Message> got;
  const MonotonicTime end = read_clocks().mono + kPatience;
  while (!got && read_clocks().mono < end) got = ends.link.receive(read_clocks());
  REQUIRE(got);
  CHECK(got->subtype == "ack");
}
