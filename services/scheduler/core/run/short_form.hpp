// Results and batons as they travel to a member that has the run's definition: without what follows from it. Of a
// signed result only what its robot has said and the signature travel; the reader makes the same bytes again.
//
//   short form = tag [ epoch final skipped ] *result        ; in brackets: of a baton
//   tag        = the first 8 bytes of BLAKE2b-256 over run id and digest
//   final, skipped = count *length                          ; tasks in turn not so and so; 0: as in the body's bitmap
//   result     = task robot bits [ attempt epoch ] [ size reason size data ] started lasted duration signature
//   robot      = its place among the start's members
//   bits       = OCTET ; 0-3: outcome, 4: goes on, 5: with reason and data, 6: attempt or epoch is not 1, 7: 8 bytes
//   started    = ns from the run's creation; lasted = ns from then to `ended`
//   duration   = ns that it is more than `lasted`; with bit 7 as it is in memory, the lowest byte first
//   signature  = 64OCTET                                    ; all other numbers are varints
#pragma once

#include "common/base/result.hpp"
#include "proto/bodies/run_exchange.hpp"
#include "services/scheduler/core/run/run_definition.hpp"

namespace trb::scheduler {

/// The name of a run and its definition; empty: what travels is in its long form.
BytesView tag_of(const Blob& short_form);

/// Changes a body's form. A record that would not come back as it is, byte for byte, keeps its long form.
void shorten(Baton& baton, const RunDefinition& definition);
void shorten(Results& results, const RunDefinition& definition);

/// The inverse; the definition must be the tag's. Errors: malformed, bad_value (a task, robot or outcome that is none).
Result<Baton> lengthened(Baton baton, const RunDefinition& definition);
Result<Results> lengthened(Results results, const RunDefinition& definition);

}  // namespace trb::scheduler
