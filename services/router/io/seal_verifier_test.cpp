// Seals that are checked on a thread of their own.
#include "services/router/io/seal_verifier.hpp"

#include "services/router/io/event_to_end_reason.hpp"
#include "services/router/test/test_shell.hpp"

using namespace trb;
using namespace trb::router;

TEST_CASE("a seal that is none ends its link, once the thread has looked at it") {
  ShellParts parts;
  SealVerifier seals(parts.shell);
  seals.watch();
  seals.check({7, 3, 3, {}, std::make_shared<const Certificate>(parts.ant.bee.certificate)});
  CHECK(parts.turn_until([&] { return parts.counted("refused.seal_broken") + parts.ordered.list.size() > 0; }));
}

TEST_CASE("given frames that wait for their seal, then it is checked at once, and costs much of the turn") {
  ShellParts parts(true);
  SealVerifier seals(parts.shell);
  const auto bee = std::make_shared<const Certificate>(parts.ant.bee.certificate);
  seals.check({7, 3, 3, {}, bee});
  CHECK(parts.shell.spent() == 0);
  Link link;
  link.id = 7;
  parts.core.seals().open(link);
  seals.check({7, 3, 3, {}, bee});
  CHECK(parts.counted("refused.seal_broken") + parts.ordered.list.size() > 0);
  CHECK(parts.shell.spent() == 32);
}

TEST_CASE("an event of a connection that is not its end is none") {
  CHECK_FALSE(to_end_reason(LinkEvent::connected));
  CHECK_FALSE(to_end_reason(LinkEvent::reached));
  CHECK_FALSE(to_end_reason(LinkEvent::accept_failed));
  CHECK(to_end_reason(LinkEvent::refused_key) == LinkEndReason::refused_key);
  CHECK(to_end_reason(LinkEvent::disconnected) == LinkEndReason::disconnected);
}
