// A run's id, which proves whose run it is: a member that learns it cannot give others a run of its own by this id
// first.
#pragma once

#include <string>
#include <string_view>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"

namespace trb {

constexpr std::size_t kRunIdRandom = 7;  ///< random bytes in an id: two runs of one submitter never have the same

/// 32 lower-case hexadecimal digits, of 16 bytes: the 7 random ones, 5 of the digest of the submitter's id and of them,
/// and a mark of 4 by which an id of this kind is known. `random` has kRunIdRandom bytes.
std::string make_run_id(std::string_view submitter, BytesView random);

/// Is it an id, and if it has the mark, an id of this submitter's? An id without the mark is an earlier version's: 16
/// random bytes, which anybody can claim. Errors: bad_value.
Status check_run_id(std::string_view run, std::string_view submitter);

}  // namespace trb
