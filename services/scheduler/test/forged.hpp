// Signed records that nobody may pass on.
#pragma once

#include <doctest/doctest.h>

#include <string_view>

#include "proto/bodies/signed.hpp"

namespace trb::scheduler::test {

/// Of a good record: with a bit changed, of another kind, or in a stranger's name, it is refused. `refused`: the code.
template <class Refused>
void check_forged(const SignedRecord& good, std::string_view other_kind, const Refused& refused) {
  SignedRecord changed = good;
  changed.payload.bytes.back() = static_cast<char>(changed.payload.bytes.back() ^ 1);
  CHECK(refused(changed) == "bad_signature");
  SignedRecord other = good;
  other.kind = other_kind;
  CHECK(refused(other) == "bad_signature");
  SignedRecord strange = good;
  strange.signer = "stranger";
  CHECK(refused(strange) == "not_permitted");
}

}  // namespace trb::scheduler::test
