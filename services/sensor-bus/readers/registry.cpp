#include "services/sensor-bus/readers/registry.hpp"

namespace trb::sensor {

void run_reader(ReadBy kind, ReaderContext& context) {
#define TRB_CASE(KIND, ...) \
  case ReadBy::KIND:        \
    return run_##KIND(context);
  switch (kind) { TRB_READER_KINDS(TRB_CASE) }
#undef TRB_CASE
}

}  // namespace trb::sensor
