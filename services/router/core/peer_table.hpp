// The routing table of section 3.2.1: the peers, the links to them, and the addresses this node dials.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "common/base/lookup_table.hpp"
#include "services/router/core/config.hpp"
#include "services/router/core/link_deadlines.hpp"
#include "services/router/core/peers.hpp"

namespace trb::router {

class PeerTable {
 public:
  /// The seeds of node.json, and the hints of the previous run whose key no seed has, until their peer is met.
  explicit PeerTable(const RouterConfig& config);

  using Peers = std::map<std::string, Peer, std::less<>>;
  using Links = std::map<LinkId, Link>;
  [[nodiscard]] const Peers& peers() const { return peers_; }
  [[nodiscard]] const Links& links() const { return links_; }
  [[nodiscard]] std::vector<Seed>& seeds() { return seeds_; }
  [[nodiscard]] const std::vector<Seed>& seeds() const { return seeds_; }

  /// Who gets a row to change it, by any way, makes its deadline be looked at again.
  [[nodiscard]] LinkDeadlines& deadlines();
  /// The deadlines give rows, too.
  void touch(Link& link) { deadlines_.touch(link); }
  void touch(Peer& peer) { deadlines_.touch(peer); }
  /// All peers, to change them.
  [[nodiscard]] Peers& change_peers();

  // ---- peers; nullptr: none

  [[nodiscard]] Peer* find(std::string_view id);
  [[nodiscard]] const Peer* find(std::string_view id) const;
  [[nodiscard]] Peer* by_key(BytesView key);
  /// Does a peer or a seed have this key?
  [[nodiscard]] bool is_expected(BytesView key) const;
  /// Is there a row for it, or room for one?
  [[nodiscard]] bool has_room_for(std::string_view id) const;
  /// The row of that member, new or updated by this certificate. A member with other keys than before is another
  /// computer: it gets a number of its own.
  Peer& learn(const Certificate& certificate, const SignedRecord& record);
  void forget(const std::string& id);
  /// The owner of this key is linked: what the previous run knew of its address is of no use any more.
  void forget_hints(BytesView key);
  /// How many seeds and hints have an owner that was not linked since this start.
  [[nodiscard]] std::size_t awaited() const;
  /// How many were forgotten.
  [[nodiscard]] std::uint64_t forgotten() const { return forgotten_; }

  // ---- links; nullptr: none

  [[nodiscard]] Link* link(LinkId id);
  [[nodiscard]] const Link* link(LinkId id) const;
  /// A link with an id that none has.
  Link& add(Link link);
  void remove(LinkId id);
  /// How many were removed.
  [[nodiscard]] std::uint64_t removed() const { return removed_; }
  /// Those with this key at the other side, by their ids.
  [[nodiscard]] std::vector<LinkId> links_of(BytesView key) const;
  /// The link that is up with the peer of this key.
  [[nodiscard]] Link* linked_by_key(BytesView key);
  /// The links that carry messages, by the ids of their peers.
  [[nodiscard]] std::vector<LinkId> up_links() const;
  /// Is a link being dialled to this key? One at a time: a seed and a beacon may name the same node.
  [[nodiscard]] bool is_dialling(BytesView key) const;

 private:
  Peers peers_;
  LookupTable<std::string_view, Peer> by_id_;  ///< the same rows, for those who look one up
  std::map<Bytes, std::string, std::less<>> by_key_;
  Links links_;
  LookupTable<LinkId, Link> by_link_;
  std::vector<Seed> seeds_;
  std::uint64_t last_number_ = 0, forgotten_ = 0, removed_ = 0;
  std::set<std::pair<Bytes, LinkId>> links_by_key_;
  LinkDeadlines deadlines_;
};

}  // namespace trb::router
