// trb-ros-worker: the ROS handles of trb-ros-bridge, which starts it, speaks with it through descriptor 3 and kills it
// when it hangs: a call to a ROS master that has stopped blocks for ever.
#include <poll.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sys/socket.h>
#include <topic_tools/shape_shifter.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <map>
#include <memory>
#include <string>
#include <utility>

#include "services/ros-bridge/core/message_codec.hpp"
#include "services/ros-bridge/core/worker_syntax.hpp"
#include "services/ros-bridge/worker/receivers.hpp"

namespace trb::ros {
namespace {

namespace roscpp = ::ros;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr int kBridge = 3;
constexpr milliseconds kTurn{5};
constexpr milliseconds kAlive{500};
constexpr milliseconds kBetweenMessages{20};
constexpr milliseconds kBetweenRenewals{1000};
constexpr int kMasterIsNew = 3;
constexpr int kShutDown = 4;

class Worker {
 public:
  explicit Worker(std::string master) : master_(std::move(master)) {}

  int run() {
    for (;;) {
      pollfd bridge{kBridge, POLLIN, 0};
      ::poll(&bridge, 1, static_cast<int>(kTurn.count()));
      if (bridge.revents != 0 && !receive()) return 0;
      const bool is_new = Clock::now() >= next_alive_ && !look_at_master();
      if (roscpp::isShuttingDown()) return kShutDown;  // a master that then does not know this node need not be new
      if (is_new) return kMasterIsNew;
      if (!node_) continue;
      roscpp::getGlobalCallbackQueue()->callAvailable();
      publish_due();
      send_newest();
      renew_subscriptions();
    }
  }

 private:
  struct Waiting {
    Bytes token;
    std::string topic;
    Bytes wire;
    Clock::time_point deadline;
  };
  struct Publisher {
    std::string sum;
    std::string type;
    topic_tools::ShapeShifter message;
    roscpp::Publisher publisher;
    Receivers receivers;
  };
  using Heard = roscpp::MessageEvent<topic_tools::ShapeShifter const>;
  struct Subscription {
    roscpp::Subscriber subscriber;
    Clock::time_point next;
    Heard::ConstMessagePtr newest{};  ///< it came too soon after the last one that was told
    Heard::ConstMessagePtr kept{};    ///< of a latched topic, for a further listener
    bool connected = false;           ///< it has had a publisher
    Clock::time_point renewed{};
  };

  static void send_to_bridge(Word word, std::vector<Bytes> parts) {
    const Bytes bytes = to_bytes({word, std::move(parts)});
    for (std::size_t sent = 0; sent < bytes.size();) {
      const ssize_t now = ::send(kBridge, bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL);
      if (now < 0 && errno != EINTR) std::_Exit(0);
      if (now > 0) sent += static_cast<std::size_t>(now);
    }
  }
  static void refuse(const Bytes& token, std::string_view code, const std::string& what, const std::string& hint) {
    send_to_bridge(Word::failed, {token, Bytes(code), what, hint});
  }

  /// False: the bridge is gone.
  bool receive() {
    Bytes bytes(65536, '\0');
    const ssize_t size = ::recv(kBridge, bytes.data(), bytes.size(), MSG_DONTWAIT);
    if (size <= 0) return size < 0 && (errno == EAGAIN || errno == EINTR);
    bytes.resize(static_cast<std::size_t>(size));
    std::vector<WorkerMessage> messages;
    if (!reader_.add(bytes, messages)) return false;
    for (const WorkerMessage& message : messages) on(message);
    return true;
  }

  void on(const WorkerMessage& message) {
    // The bridge requests nothing before it knows that the master is there.
    if (!node_) return;
    try {
      carry_out(message);
    } catch (const roscpp::Exception& problem) {
      on_refused(message, problem.what());
    }
  }

  /// It may throw at a name that ROS does not take.
  void carry_out(const WorkerMessage& message) {
    const auto& parts = message.parts;
    if (message.word == Word::look_up) return look_up(parts[0]);
    if (message.word == Word::publish) return take_publication(parts);
    if (message.word == Word::subscribe) return subscribe(parts[0]);
    if (message.word == Word::unsubscribe) subscriptions_.erase(parts[0]);
    if (message.word == Word::drop) {
      std::erase_if(waiting_, [&](const Waiting& waiting) { return waiting.token == parts[0]; });
    }
  }

  void on_refused(const WorkerMessage& message, const std::string& why) {
    const auto& parts = message.parts;
    if (message.word == Word::look_up) return send_to_bridge(Word::type, {parts[0], ""});
    if (message.word == Word::subscribe) {
      return send_to_bridge(Word::topic_failed, {parts[0], "bad_value", parts[0] + ": " + why, ""});
    }
    if (message.word != Word::publish) return;
    give_up(parts[1], "cannot be published");
    refuse(parts[0], "bad_value", parts[1] + ": " + why, "");
  }

  /// False: another master has come up in its place; what is registered with the old one is lost.
  bool look_at_master() {
    XmlRpc::XmlRpcValue request;
    XmlRpc::XmlRpcValue response;
    XmlRpc::XmlRpcValue pid;
    request[0] = roscpp::this_node::getName();
    const bool there = roscpp::master::execute("getPid", request, response, pid, false);
    next_alive_ = Clock::now() + kAlive;
    if (!there) {
      send_to_bridge(Word::alive, {"absent", "no ROS master at " + master_});
      return true;
    }
    const int number = pid;
    if (node_ && number != pid_) return false;
    pid_ = number;
    // In a container every master has the same pid; a new one has forgotten this node.
    if (node_ && !remembers()) return false;
    if (!node_) {
      node_ = std::make_unique<roscpp::NodeHandle>();
      (void)remembers();  // at once: the next look may already find another master
    }
    send_to_bridge(Word::alive, {"up", ""});
    return true;
  }

  /// False once the master, which knew this node, knows it no more.
  bool remembers() {
    XmlRpc::XmlRpcValue request;
    XmlRpc::XmlRpcValue response;
    XmlRpc::XmlRpcValue address;
    request[0] = request[1] = roscpp::this_node::getName();
    const bool known = roscpp::master::execute("lookupNode", request, response, address, false);
    const bool forgotten = was_known_ && !known;
    was_known_ = known;
    return !forgotten;
  }

  /// The master's call knows the topics that only have subscribers, too.
  void look_up(const std::string& topic) const {
    XmlRpc::XmlRpcValue request;
    XmlRpc::XmlRpcValue response;
    XmlRpc::XmlRpcValue types;
    request[0] = roscpp::this_node::getName();
    std::string type;
    if (roscpp::master::execute("getTopicTypes", request, response, types, false)) {
      const std::string full = roscpp::names::resolve(topic);
      for (int i = 0; i < types.size(); ++i) {
        if (std::string(types[i][0]) == full) type = std::string(types[i][1]);
      }
    }
    send_to_bridge(Word::type, {topic, type == "*" ? "" : type});
  }

  void take_publication(const std::vector<Bytes>& parts) {
    const std::string& topic = parts[1];
    const auto known = publishers_.find(topic);
    if (known != publishers_.end() && known->second.sum != parts[3]) give_up(topic, "is now published as " + parts[2]);
    Publisher& publisher = publishers_[topic];
    if (!publisher.publisher) {
      publisher.sum = parts[3];
      publisher.type = parts[2];
      publisher.message.morph(parts[3], parts[2], parts[4], "0");
      publisher.publisher = advertise(topic, parts);
    }
    if (!publisher.publisher) {
      give_up(topic, "cannot be published");
      return refuse(parts[0], "robot_error", topic + ": ROS refuses to publish " + parts[2] + " there", "");
    }
    was_known_ = true;  // ROS has registered the topic
    // The bridge's clock is this one: what was read late, behind a call to the master, has waited all the same.
    waiting_.push_back({parts[0], topic, parts[6], Clock::time_point(std::chrono::nanoseconds(std::stoll(parts[5])))});
  }

  roscpp::Publisher advertise(const std::string& topic, const std::vector<Bytes>& parts) {
    const auto comes = [this, topic](const roscpp::SingleSubscriberPublisher& to) {
      if (const auto at = publishers_.find(topic); at != publishers_.end()) {
        at->second.receivers.add(to.getSubscriberName());
      }
    };
    const auto goes = [this, topic](const roscpp::SingleSubscriberPublisher& to) {
      if (const auto at = publishers_.find(topic); at != publishers_.end()) {
        at->second.receivers.remove(to.getSubscriberName());
      }
    };
    // What does not fit into ROS' queue is thrown away, and was told to be published.
    roscpp::AdvertiseOptions options(topic, kMaxPublications, parts[3], parts[2], parts[4], comes, goes);
    return node_->advertise(options);
  }

  void give_up(const std::string& topic, const std::string& why) {
    publishers_.erase(topic);
    std::erase_if(waiting_, [&](const Waiting& waiting) {
      if (waiting.topic != topic) return false;
      refuse(waiting.token, "robot_error", topic + " " + why, "");
      return true;
    });
  }

  /// A ShapeShifter is empty until it is filled, and would copy from nowhere if it were filled with nothing.
  static void fill(topic_tools::ShapeShifter& message, Bytes& wire) {
    if (wire.empty()) return;
    auto* bytes = reinterpret_cast<std::uint8_t*>(wire.data());
    roscpp::serialization::IStream stream(bytes, static_cast<std::uint32_t>(wire.size()));
    message.read(stream);
  }

  static void refuse_late(const Waiting& waiting, const Publisher& publisher) {
    if (!publisher.receivers.empty()) {
      return refuse(waiting.token, "timeout", waiting.topic + ": its time was over before it could be published",
                    "look whether the ROS master answers slowly");
    }
    refuse(waiting.token, "timeout", waiting.topic + ": nobody subscribes to it as " + publisher.type,
           "start the robot's node; if it runs, let it through the firewall here (it connects to this computer, at any "
           "port), and compare the sums: rosmsg md5 " +
               publisher.type + " is " + publisher.sum + " here");
  }

  /// Connecting takes some 50 ms: what is published before a subscriber is there would be lost.
  void publish_due() {
    std::vector<Waiting> still;
    std::map<std::string, bool> blocked;  // what waits on a topic stays in order
    for (Waiting& waiting : waiting_) {
      Publisher& publisher = publishers_.at(waiting.topic);
      if (Clock::now() >= waiting.deadline) {
        refuse_late(waiting, publisher);
      } else if (!blocked[waiting.topic] && publisher.receivers.are_complete(waiting.topic)) {
        fill(publisher.message, waiting.wire);
        publisher.publisher.publish(publisher.message);
        send_to_bridge(Word::published, {waiting.token});
      } else {
        blocked[waiting.topic] = true;
        still.push_back(std::move(waiting));
      }
    }
    waiting_.swap(still);
  }

  void subscribe(const std::string& topic) {
    if (!subscriptions_.contains(topic)) {
      subscriptions_[topic].subscriber = listen(topic, &Subscription::newest);
      return;
    }
    // ROS gives a latched topic's last message to each new subscriber at once, and to no other.
    const roscpp::Subscriber further = listen(topic, &Subscription::kept);
    roscpp::getGlobalCallbackQueue()->callAvailable();
  }

  roscpp::Subscriber listen(const std::string& topic, Heard::ConstMessagePtr Subscription::*place) {
    return node_->subscribe<topic_tools::ShapeShifter const>(
        topic, 2, boost::function<void(const Heard&)>([this, topic, place](const Heard& heard) {
          const auto at = subscriptions_.find(topic);
          if (at == subscriptions_.end()) return;
          at->second.*place = heard.getConstMessage();
          send_if_due(topic, at->second);
        }));
  }

  /// The last message of a topic that then falls silent is not lost.
  void send_newest() {
    for (auto& [topic, subscription] : subscriptions_) send_if_due(topic, subscription);
  }

  /// A subscription takes for good the type of its first publisher, and ROS then refuses it to one of another type.
  void renew_subscriptions() {
    for (auto& [topic, subscription] : subscriptions_) {
      if (subscription.subscriber.getNumPublishers() > 0) {
        subscription.connected = true;
      } else if (subscription.connected && Clock::now() >= subscription.renewed + kBetweenRenewals) {
        subscription.connected = false;
        subscription.renewed = Clock::now();
        subscription.subscriber.shutdown();
        subscription.subscriber = listen(topic, &Subscription::newest);
      }
    }
  }

  /// The bridge reads no larger one, and takes what is far larger for garbage.
  static bool is_too_large(const topic_tools::ShapeShifter& message) {
    const std::size_t head =
        message.getDataType().size() + message.getMD5Sum().size() + message.getMessageDefinition().size();
    return message.size() > kMaxMessage || head > kMaxMessage;
  }

  static void send_if_due(const std::string& topic, Subscription& subscription) {
    if ((!subscription.newest && !subscription.kept) || Clock::now() < subscription.next) return;
    subscription.next = Clock::now() + kBetweenMessages;
    const Word word = subscription.newest ? Word::message : Word::kept;  // a new one goes to every listener
    const auto message = subscription.newest ? subscription.newest : subscription.kept;
    subscription.newest = subscription.kept = nullptr;
    if (is_too_large(*message)) {
      return send_to_bridge(Word::unread, {topic, "too_large", topic + ": a message of over 1 MiB", ""});
    }
    Bytes wire(message->size(), '\0');
    roscpp::serialization::OStream stream(reinterpret_cast<std::uint8_t*>(wire.data()), message->size());
    message->write(stream);
    send_to_bridge(word, {topic, message->getDataType(), message->getMD5Sum(), message->getMessageDefinition(), wire});
  }

  std::string master_;
  WorkerReader reader_;
  std::unique_ptr<roscpp::NodeHandle> node_;
  int pid_ = 0;
  bool was_known_ = false;  ///< the master knew this node when it was last asked
  Clock::time_point next_alive_;
  std::map<std::string, Publisher> publishers_;
  std::map<std::string, Subscription> subscriptions_;
  std::vector<Waiting> waiting_;
};

}  // namespace
}  // namespace trb::ros

int main(int argc, char** argv) {
  if (argc != 5) {
    std::fputs("trb-ros-worker is started by trb-ros-bridge\n", stderr);
    return 2;
  }
  try {
    const ros::M_string remappings{{"__master", argv[1]}, {"__ip", argv[2]}, {"__ns", argv[4]}};
    ros::init(remappings, argv[3], ros::init_options::NoSigintHandler | ros::init_options::NoRosout);
    return trb::ros::Worker(argv[1]).run();
  } catch (const std::exception& problem) {
    std::fprintf(stderr, "trb-ros-worker: %s\n", problem.what());
    return 1;
  }
}
