// The seal book by itself: which seals go with a frame, and what happens if something does not leave.
#include "services/router/core/seal_book.hpp"

#include "services/router/test/test_parts.hpp"

using namespace trb;
using namespace trb::router;

namespace {

struct Book : Parts {
  Link& link = link_with(bee);
  Bytes frame = encode_frame(make_message(MessageType::information, "ant", "bee", RobotFault{}));

  Outgoing send() { return seals.send(link.id, frame.data(), frame.size(), now); }
  void send(std::size_t times) {
    for (std::size_t i = 0; i < times; ++i) send();
  }
  [[nodiscard]] std::uint64_t next() const { return seals.next_sequence(link.id); }
  static std::uint64_t sequence_of(BytesView one) { return decode_frame(one)->sequence; }
};

}  // namespace

TEST_CASE("given 64 frames without a seal, when the next one leaves, then their seal leaves before it") {
  Book book;
  book.send(kMaxUnsealed);
  CHECK(book.seals.is_overdue(book.link.id));
  const Outgoing next = book.send();
  REQUIRE_FALSE(next.before.empty());
  CHECK(next.behind.empty());
  CHECK(Book::sequence_of(next.before) == 65);
  CHECK(Book::sequence_of(book.frame) == 66);
  CHECK_FALSE(book.seals.is_overdue(book.link.id));
  CHECK(book.counters.value("seals.sent") == 1);
}

TEST_CASE("given that the seal before a frame could not leave, then neither has its number, and it is tried again") {
  Book book;
  book.send(kMaxUnsealed);
  const Outgoing first = book.send();
  book.seals.not_sent(book.link.id, Unsent::before);
  CHECK(book.counters.value("seals.sent") == 0);
  CHECK(book.next() == 65);
  const Outgoing again = book.send();
  CHECK(Book::sequence_of(again.before) == 65);
  CHECK(Book::sequence_of(book.frame) == 66);
}

TEST_CASE("given a peer that wants each message sealed, then a seal follows each, and a failure takes both back") {
  Book book;
  book.seals.bind(book.link, book.bee.certificate,
                  {book.bee.record, 3, "", "1", kStartUtc, true, {}, 0, std::string(kSealBeforeDelivery), false, {}});
  const Outgoing one = book.send();
  CHECK(Book::sequence_of(book.frame) == 1);
  CHECK(Book::sequence_of(one.behind) == 2);
  SUBCASE("the frame did not leave") {
    book.seals.not_sent(book.link.id, Unsent::frame);
    CHECK(book.next() == 1);
    CHECK_FALSE(book.seals.is_overdue(book.link.id));
  }
  SUBCASE("its seal did not leave: it goes before the next frame") {
    book.seals.not_sent(book.link.id, Unsent::behind);
    CHECK(book.next() == 2);
    const Outgoing two = book.send();
    CHECK(Book::sequence_of(two.before) == 2);
    CHECK(Book::sequence_of(book.frame) == 3);
    CHECK(Book::sequence_of(two.behind) == 4);
  }
}

TEST_CASE("a seal that left long ago is not taken back with a later frame") {
  Book book;
  book.send(1);
  REQUIRE(book.seals.make_seal(book.link.id, book.now));
  book.send(2);
  book.seals.not_sent(book.link.id, Unsent::frame);
  CHECK(book.next() == 4);
  CHECK(book.counters.value("seals.sent") == 1);
}

TEST_CASE("given frames that arrive, then the 65th without a seal, and an unsealed second keep-alive, are faults") {
  Book book;
  const auto arrives = [&](const Message& message, std::uint64_t sequence) {
    return book.seals.receive(book.link.id, header_of(message, sequence), encode_frame(message));
  };
  SUBCASE("many frames") {
    const Message note = make_message(MessageType::information, "bee", "ant", RobotFault{});
    for (std::uint64_t i = 1; i <= kMaxUnsealed; ++i) REQUIRE(arrives(note, i) == SealFault::none);
    CHECK(arrives(note, kMaxUnsealed + 1) == SealFault::missing);
  }
  SUBCASE("keep-alives") {
    const Message alive = make_message(MessageType::information, "bee", "ant", KeepAlive{});
    CHECK(arrives(alive, 1) == SealFault::none);
    CHECK(arrives(alive, 2) == SealFault::late);
  }
}

TEST_CASE("a frame's seal has its time at once: no tick is needed that would only set it") {
  Book book;
  book.send();
  CHECK(book.seals.next_deadline() == book.now.mono + kSealWithin);
  SUBCASE("frames behind the first do not move it") {
    book.now.mono = book.now.mono + std::chrono::milliseconds(5);
    book.send();
    CHECK(book.seals.next_deadline() == book.now.mono + kSealWithin - std::chrono::milliseconds(5));
  }
  SUBCASE("the 64th makes it due") {
    book.now.mono = book.now.mono + std::chrono::milliseconds(5);
    book.send(kMaxUnsealed - 1);
    CHECK(book.seals.next_deadline() == book.now.mono);
  }
}
