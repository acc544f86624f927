// Frames from a link and from a stranger, up to a Hello with a valid certificate.
#include "tests/fuzz/router_under_test.hpp"

namespace trb::fuzz {
namespace {

using namespace trb::router;

constexpr LinkId kLink = 7;

Bytes frame_of(const Message& message, std::uint64_t sequence) {
  Bytes frame = encode_frame(message);
  stamp_link(frame.data(), kLink, sequence, message.remaining_ms);
  return frame;
}

template <class T>
Bytes frame_of(const T& body, std::uint64_t sequence, MessageType type = MessageType::information) {
  return frame_of(make_message(type, "bee", "ant", body), sequence);
}

/// The shell's handling of a frame from a link that is up.
void from_member(RouterCore& core, BytesView frame) {
  const auto header = decode_frame(frame);
  if (!header) return;
  Effects effects;
  core.forwarding().from_link(kLink, *header, frame, kNow, effects);
  const Bytes copy = encode_frame(to_message(*header));
  const auto again = decode_frame(copy);
  require(again && again->subtype == header->subtype && again->data == header->data, "a frame survives its own copy");
}

/// Bee's Hello, as frame 1 of the link.
void come_up(RouterCore& core) {
  const Keys& keys = Keys::get();
  const Message hello = make_message(MessageType::information, "bee", "ant", make_hello(keys.bee, "bee"));
  const Bytes frame = frame_of(hello, 1);
  Effects effects;
  core.forwarding().from_stranger(keys.bee.link.public_key, *decode_frame(frame), frame, kNow, effects);
}

/// The contents of bee's first seal: its Hello and one message.
SealedRange first_range() {
  const Keys& keys = Keys::get();
  SealWriter writer;
  writer.add(frame_of(make_hello(keys.bee, "bee"), 1));
  writer.add(frame_of(KeepAlive{1}, 2));
  return writer.range({kLink, keys.bee.certificate.serial, keys.ant.certificate.serial, true}, kNow.utc);
}

/// A member's signature on any range: only with the range that is due the link goes on.
void seal_that_is_signed(BytesView input) {
  const auto range = decode<SealedRange>(input);
  if (!range) return;
  const Keys& keys = Keys::get();
  RouterCore core = make_router();
  come_up(core);
  from_member(core, frame_of(KeepAlive{1}, 2));
  from_member(core, frame_of(Seal{sign_seal(*range, "bee", keys.authority.fleet.id(), keys.bee.identity)}, 3));
  Effects effects;
  core.tick(kNow, effects);
  const SealedRange due = first_range();
  const bool holds = range->hash == due.hash && range->previous == due.previous && range->first == due.first &&
                     range->last == due.last && range->link == due.link && range->dialled == due.dialled &&
                     range->serial == due.serial && range->peer_serial == due.peer_serial;
  require(holds == (core.table().link(kLink) != nullptr),
          "the link lives if, and only if, its seal is the one that is due");
}

void from_stranger(RouterCore& core, BytesView frame, BytesView key) {
  const auto header = decode_frame(frame);
  if (!header) return;
  Effects effects;
  core.inbox().on_message(header->link, key, to_message(*header), header->sequence, kNow, effects);
}

/// A Hello with any certificate, as if the authority had signed it.
void hello_that_holds(BytesView input) {
  auto hello = decode<Hello>(input);
  if (!hello) return;
  hello->certificate = Keys::get().sign_as_authority(kSignedCertificate, hello->certificate.payload.bytes);
  const auto certificate = decode<Certificate>(hello->certificate.payload.bytes);
  if (!certificate) return;
  RouterCore core = make_router();
  Effects effects;
  core.inbox().on_message(kLink, certificate->link_key.bytes,
                          make_message(MessageType::information, certificate->id, "ant", *hello), 1, kNow, effects);
  core.tick({kNow.mono + std::chrono::seconds(30), kNow.utc + std::chrono::seconds(30)}, effects);
  check_table(core);
}

/// A call with an invited key, and an invitation that the authority has signed: whatever they carry, the mailbox is
/// bounded.
void door_of_a_cloud(BytesView input) {
  const Keys& keys = Keys::get();
  const InvitationKeys code = invitation_keys("a code");
  RouterConfig config;
  config.id = "ant";
  config.role = Role::cloud;
  config.authority = keys.authority.fleet;
  config.random = random_u64;
  LocalNode node(std::move(config));
  PeerTable table(node.config());
  LinkErrors errors(table);
  TrustStore trust(node, table, errors);
  Admission admission(node, table, trust);
  Invitations door(node, admission);
  const Invitation invitation{
      {keys.authority.fleet.id()}, "cat", Role::robot, {code.caller.public_key}, kNow.utc.ns + 1'000'000'000};
  HoldInvitation order{sign_invitation(invitation, keys.authority.key), 1, {"offer"}, false};
  Effects effects;
  require(door.hold_own(order, kNow, effects).ok(), "the authority's invitation is held");
  if (auto any = decode<HoldInvitation>(input)) {
    any->invitation = keys.sign_as_authority(kSignedInvitation, any->invitation.payload.bytes);
    (void)door.hold_own(*any, kNow, effects);
  }
  const auto call = decode<JoinCall>(input);
  for (int i = 0; call && i < 6; ++i) {
    JoinCall more = *call;
    more.word.bytes += static_cast<char>(i);
    (void)door.call(code.caller.public_key, more, kNow, effects);
  }
  const auto state = door.hold_own(order, kNow, effects);
  require(state && state->words.size() <= kMaxJoinBoxes, "few words are kept");
  door.tick({kNow.mono + kInvitationTime, kNow.utc + kInvitationTime}, effects);
  require(!door.is_invited(code.caller.public_key), "the door closes");
}

}  // namespace

std::vector<Bytes> seeds() {
  const Keys& keys = Keys::get();
  NodeProfile profile;
  profile.framework = "ur";
  profile.mode = "direct";
  profile.capabilities = {"grab"};
  profile.skills = {{"grab_left", "grab", {{"height", "number", true, "m"}}, false, 5}};
  profile.robot = "ONLINE";
  Hello hello = make_hello(keys.cat, "cat");
  hello.profile = profile;
  const Message move{
      .type = MessageType::command, .subtype = "move", .source = "bee", .target = "ant", .id = 9, .data = "[1,2,3]"};
  return {
      encode(hello),
      encode(make_hello(keys.bee, "bee")),
      frame_of(make_hello(keys.bee, "bee"), 1),
      frame_of(KeepAlive{1}, 2),
      frame_of(Goodbye{"over"}, 2),
      frame_of(profile, 2),
      frame_of(RouteListRequest{}, 2, MessageType::request),
      frame_of(EchoRequest{{"pad"}}, 2, MessageType::request),
      frame_of(TrustUpdate{{}, {keys.cat.record}}, 2),
      frame_of(Seal{sign_seal(first_range(), "bee", keys.authority.fleet.id(), keys.bee.identity)}, 2),
      frame_of(ReachablePeerList{{keys.cat.record}, {"dog"}}, 2),
      frame_of(move, 2),
      frame_of(JoinCall{{"word"}}, 1),
      encode(JoinCall{{"word"}}),
      encode(HoldInvitation{keys.sign_as_authority(kSignedInvitation, encode(Invitation{{keys.authority.fleet.id()},
                                                                                        "dog",
                                                                                        Role::robot,
                                                                                        {keys.bee.link.public_key},
                                                                                        kNow.utc.ns + 1'000'000'000})),
                            2,
                            {"offer"},
                            false}),
      encode(first_range())};
}

void run(BytesView input) {
  const Keys& keys = Keys::get();
  RouterCore core = make_router();
  from_stranger(core, input, keys.cat.link.public_key);
  come_up(core);
  from_member(core, input);
  Effects effects;
  core.tick({kNow.mono + std::chrono::seconds(30), kNow.utc + std::chrono::seconds(30)}, effects);
  check_table(core);
  hello_that_holds(input);
  seal_that_is_signed(input);
  door_of_a_cloud(input);
}

}  // namespace trb::fuzz
