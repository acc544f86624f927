#include "proto/shape.hpp"

#include <array>
#include <cassert>

#include "proto/body.hpp"
#include "proto/make_shape.hpp"

namespace trb {

const Shape& shape_of(BodyKind kind) {
  static const std::array all{
#define TRB_SHAPE(Name) &make_shape<Name>(),
      TRB_BODIES(TRB_SHAPE)
#undef TRB_SHAPE
  };
  assert(kind != BodyKind::Opaque);
  return *all[static_cast<std::size_t>(kind) - 1];
}

}  // namespace trb
