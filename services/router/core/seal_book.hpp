// The seals of all links: what each direction has sealed, which seals are due, what is still to be checked
// (proto/README.md, "Seals"). Made and checked after the delivery, or before it if a node is configured so.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/actor/counter_table.hpp"
#include "common/base/deadline_index.hpp"
#include "common/base/lookup_table.hpp"
#include "services/router/core/link_seals.hpp"
#include "services/router/core/own_messages.hpp"

namespace trb::router {

/// A frame that leaves by a link: it is numbered, and these go with it.
struct Outgoing {
  bool known = false;  ///< false: there is no such link, and nothing leaves
  Bytes before;        ///< a seal that leaves before it; empty: none
  Bytes behind;        ///< a seal that leaves right behind it; empty: none
};
/// Which part of an Outgoing, or which seal, did not leave; the parts behind it did not leave either.
enum class Unsent : unsigned char { before, frame, behind };

/// out    | event                             | next
/// -------|-----------------------------------|------------------------------------------------------------------
/// sealed | a frame leaves                    | open: a seal within 20 ms; at once, if each is to be sealed
/// open   | the 64th frame                    | overdue: a seal before the next frame, at once by the next tick
/// open   | 20 ms (expired), or a keep-alive  | SealDue, so a seal, if the peer is known
/// any    | a seal leaves                     | sealed
/// any    | a seal that could not leave       | overdue, as before
/// any    | a frame that could not leave      | as before; no seal covers it
/// -      | anything of an unknown link       | - (invalid)
///
/// in     | event                             | next
/// -------|-----------------------------------|------------------------------------------------------------------
/// any    | a frame                           | open; the 65th, or over 8 MiB that wait for their seal: missing
/// open   | a second keep-alive over it       | late (expired)
/// open   | a seal that fits                  | sealed; its signature is checked elsewhere (CheckSeal)
/// any    | another seal                      | the fault (invalid)
class SealBook {
 public:
  SealBook(const LocalNode& node, OwnMessages& messages, CounterTable& counters)
      : node_(node), messages_(messages), counters_(counters) {}

  /// This node sends its Hello on the link.
  void open(const Link& link);
  /// The other side's Hello was accepted: its certificate is known now.
  void bind(const Link& link, const Certificate& certificate, const Hello& hello);
  /// The link is closed: nothing leaves by it any more.
  void forget(LinkId link);
  [[nodiscard]] const LinkSeals* find(LinkId link) const;

  // ---- out

  /// Numbers a frame that leaves by the link, and makes the seals that go with it. not_sent() if it did not leave.
  Outgoing send(LinkId link, char* frame, std::size_t size, Now now);
  /// The frame of a seal over what is unsealed, if anything is; it leaves next. not_sent() with `behind` if it did not.
  std::optional<Bytes> make_seal(LinkId link, Now now);
  void not_sent(LinkId link, Unsent what);
  /// The sequence number of the next frame.
  [[nodiscard]] std::uint64_t next_sequence(LinkId link) const;
  [[nodiscard]] bool is_overdue(LinkId link) const;
  /// Is each message sealed by itself, at once?
  [[nodiscard]] bool seals_each(LinkId link) const;
  /// Orders a seal over what was sent.
  void seal_now(LinkId link, Effects& out) const;
  /// The last seal before a Goodbye, which no seal covers. It is made late: Nacks may still leave before it.
  void last_seal(LinkId link, Effects& out);

  // ---- in

  /// A frame arrived on a link that is up. A fault ends the link.
  SealFault receive(LinkId link, const HeaderView& header, BytesView frame);
  /// A seal arrived as the frame with this sequence number: a fault, or CheckSeal.
  SealFault close(LinkId link, Seal seal, std::uint64_t sequence, Effects& out);
  /// Its signature is good: the frames that waited for it are delivered.
  void proven(const CheckSeal& seal, Effects& out);
  /// Are messages of this link delivered only when they are proven (DeliverHeld)?
  [[nodiscard]] bool holds(LinkId link) const;
  /// The link ends: unsealed frames are authenticated, but not provable.
  void note_open_end(LinkId link, const std::string& peer, Effects& out) const;

  void tick(Now now, Effects& out);
  [[nodiscard]] std::optional<MonotonicTime> next_deadline() const { return due_.earliest(); }

 private:
  /// About the seal that was made last: its link, and what was unsealed before it.
  struct Undo {
    LinkId link = 0;  ///< 0: none was made
    SealWriter writer;
    std::optional<MonotonicTime> due;
  };
  LinkSeals* row(LinkId link);
  void seal_due(LinkId link, Now now, Effects& out);
  void stamp(LinkSeals& seals, LinkId link, char* frame, std::size_t size, Now now);
  std::optional<Bytes> seal(LinkSeals& seals, LinkId link, Now now, Undo& undo);
  void take_back_seal(LinkId link, LinkSeals& seals, Undo& undo);

  const LocalNode& node_;
  OwnMessages& messages_;
  CounterTable& counters_;
  std::shared_ptr<const SignedRecord> own_;  ///< this node's certificate, for all links since it was renewed
  std::map<LinkId, LinkSeals> rows_;         ///< until the shell has closed the link: a Goodbye follows its end
  LookupTable<LinkId, LinkSeals> by_link_;
  DeadlineIndex<LinkId> due_;
  Undo before_;
  Undo behind_;
};

}  // namespace trb::router
