// A part of resilience.json changed as a whole, as text: all other bytes of the file stay as they are.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "common/base/config_fault.hpp"
#include "proto/value.hpp"

namespace trb {

/// What a change is about, and what it looks like: the members of `policy` and `expires_s`; `criteria` and, instead of
/// weights, `judgments`; {NAME: {"at_least", "at_most"}}, the bounds of all criteria (who is not named has none).
enum class ResiliencePart : std::uint8_t { policy = 0, criteria, minimums };

/// The file's new text; `text` is the old one, empty: there is no file. It is read as `trb check` reads it; nothing: it
/// has faults, whose keys are paths into `change`. Comments within the changed part are gone, all others stay.
std::optional<std::string> edit_resilience(std::string_view text, ResiliencePart part, const Value& change,
                                           ConfigFaults& faults);

}  // namespace trb
