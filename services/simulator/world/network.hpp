// The network between the computers: connections that delay, lose, throttle and are cut; and beacons.
#pragma once

#include <functional>
#include <list>
#include <map>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "common/base/lookup_table.hpp"
#include "common/simulation/link_kind.hpp"
#include "services/router/core/effects.hpp"
#include "services/router/core/link_end_reason.hpp"
#include "services/simulator/world/dice.hpp"
#include "services/simulator/world/events.hpp"
#include "services/simulator/world/meter.hpp"
#include "services/simulator/world/wire_bytes.hpp"

namespace trb::world {

using router::ConnectionId;
using router::LinkEndReason;
using router::LinkId;
using simulation::find_link_kind;
using simulation::kLinkKinds;
using simulation::LinkKind;

/// A computer's end of the network. A connection bears the id of the link that its dialler wants.
class Host {
 public:
  Host() = default;
  Host(const Host&) = delete;
  Host& operator=(const Host&) = delete;
  [[nodiscard]] virtual const Bytes& link_key() const = 0;
  /// Somebody with this key dials.
  virtual bool admit(BytesView key) = 0;
  virtual void on_dial_connected(LinkId link) = 0;
  virtual void on_dial_ended(LinkId link, LinkEndReason how) = 0;
  virtual void on_frame(LinkId connection, BytesView dialler_key, Bytes frame) = 0;
  virtual void on_connection_end(LinkId connection) = 0;
  virtual void on_beacon(BytesView plain) = 0;

 protected:
  ~Host() = default;
};

class Network {
 public:
  Network(Events& events, Meter& meter, Dice& dice, LinkKind kind)
      : events_(events), meter_(meter), dice_(dice), kind_(std::move(kind)) {}

  void join(const std::string& id, const std::string& address, Host& host);
  /// The computer has another address from now on: its connections lead nowhere, and nobody is told.
  void move(const std::string& id, const std::string& address);
  /// The computer's processes end: its connections end, and the other ends learn of it.
  void leave(const std::string& id);
  void dial(const std::string& from, const router::Dial& dial);
  /// A connection that is made already. A dialler that is no host hears nothing, and nothing tells that.
  void attach(LinkId connection, const std::string& dialler, Bytes key, const std::string& acceptor);
  [[nodiscard]] bool has(LinkId connection) const { return by_id_.find(connection) != nullptr; }
  /// `subtype`: the frame's. False: there is no such connection any more.
  bool send(LinkId connection, const std::string& from, std::string_view subtype, Bytes frame);
  void close(LinkId connection, const std::string& by);
  void broadcast(const std::string& from, const Bytes& plain);

  /// What a message took at most that was sent and not lost: its delay, and what was before it on a narrow link.
  [[nodiscard]] Duration slowest() const { return slowest_; }

  /// The world ends: nobody needs to learn who leaves.
  void stop() { over_ = true; }

  /// Nothing that `from` sends arrives at `to` any more, and nobody is told. What waits arrives when it is healed. No
  /// connection is made then, and on an existing one only a window's bytes go the other way: TCP hears of none that
  /// they came.
  void cut(const std::string& from, const std::string& to) { cuts_.insert({from, to}); }
  void heal(const std::string& from, const std::string& to);

  /// For whoever plays tricks: it may change a frame that arrives, or lose it (false).
  std::function<bool(const std::string& from, LinkId connection, Bytes& frame)> meddle;
  /// What name servers know: HOST:PORT by a name -> HOST:PORT in numbers.
  std::map<std::string, std::string> names;

 private:
  struct Parcel {
    Bytes frame;
    bool end = false;  ///< the sender has closed
  };
  struct Way {
    std::string to;
    Host* const* host =
        nullptr;  ///< of `to`; points at a null pointer while that is away, or once its processes have ended
    MonotonicTime free{}, last{};
    std::list<Parcel> held{};  ///< while it is cut, and behind that until these have arrived; an empty deque has 0.6 kB
    bool resumes = false;      ///< what is held arrives soon
    std::uint64_t unproven = 0;  ///< bytes that came while the other way was cut
  };
  struct Connection {
    Way there, back;    ///< to the acceptor, to the dialler
    Bytes key;          ///< the dialler's
    bool lost = false;  ///< one end has moved away: nothing arrives
    [[nodiscard]] Way& way(bool to_acceptor) { return to_acceptor ? there : back; }
    [[nodiscard]] const Way& way(bool to_acceptor) const { return to_acceptor ? there : back; }
    [[nodiscard]] const std::string& sender(bool to_acceptor) const { return to_acceptor ? back.to : there.to; }
  };
  [[nodiscard]] bool is_cut(const std::string& from, const std::string& to) const {
    return !cuts_.empty() && cuts_.contains({from, to});
  }
  /// The connections that this is true of, by their ids.
  template <class Is>
  [[nodiscard]] std::vector<LinkId> connections_where(Is&& is) const;
  /// A parcel on this way does not arrive.
  bool is_stopped(Way& way, const std::string& from, const Parcel& parcel);
  [[nodiscard]] Way way_to(const std::string& id) { return {.to = id, .host = &hosts_[id]}; }
  [[nodiscard]] Host* host(const std::string& id);
  void connect(const std::string& from, const router::Dial& dial);
  void post(LinkId connection, Connection& is, bool there, Parcel parcel);
  void arrive(LinkId connection, bool there, Parcel parcel);
  void resume(LinkId connection, bool there);
  void hand_over_held(LinkId connection, bool there);
  /// When that many bytes arrive that are sent now: not before what was sent earlier.
  MonotonicTime arrival(Way& way, std::uint64_t bytes);
  void hand_over(LinkId connection, const Connection& is, bool there, Parcel parcel);
  Duration delay();
  void count(const std::string& from, const std::string& to, std::string_view subtype, std::uint64_t bytes,
             BytesView frame);

  Events& events_;
  Meter& meter_;
  Dice& dice_;
  LinkKind kind_;
  std::map<std::string, Host*> hosts_;            ///< nullptr: away
  std::map<std::string, std::string> addresses_;  ///< HOST:PORT -> id
  std::map<LinkId, Connection> connections_;
  LookupTable<LinkId, Connection>
      by_id_;  ///< the same rows: each frame looks one up when it leaves and when it arrives
  Duration slowest_{0};
  bool over_ = false;
  std::set<std::pair<std::string, std::string>> cuts_;  ///< from, to
};

}  // namespace trb::world
