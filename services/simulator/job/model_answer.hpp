// What the paper's equations say of a job: beside what was counted.
#pragma once

#include "common/model/paper.hpp"
#include "proto/value.hpp"
#include "services/simulator/job/job.hpp"

namespace trb::simulator {

/// The job's fleet in the paper's variables. Of a world: its robots are told field by field, each robot that fails is
/// one of N_f. Tasks in turn have no sensors; a scenario's blocks, sensors and requests are those of
/// model::parameters_of, with all of the fleet's robots, and sensors that tell nothing beside the requests.
model::PaperParameters parameters_of(const Job& job);

/// {"phases": {PHASE: MESSAGES}, "messages": Equation 12}; `upkeep` has no equation.
Value model_value(const model::PaperParameters& parameters);

}  // namespace trb::simulator
