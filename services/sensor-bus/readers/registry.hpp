// The readers by their kinds. A kind is a line in common/fleet/reader_kind.hpp, and run_KIND in a folder beside this.
#pragma once

#include "services/sensor-bus/readers/reader_context.hpp"

namespace trb::sensor {

// Each reads its device until it is stopped.
#define TRB_DECLARE(KIND, ...) void run_##KIND(ReaderContext& context);
TRB_READER_KINDS(TRB_DECLARE)
#undef TRB_DECLARE

/// Runs the reader of that kind.
void run_reader(ReadBy kind, ReaderContext& context);

}  // namespace trb::sensor
