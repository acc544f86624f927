#include "common/scenario/run_id.hpp"

#include <algorithm>

#include "common/base/hex.hpp"
#include "common/security/keys.hpp"

namespace trb {
namespace {

constexpr std::size_t kDigits = 32;
constexpr std::size_t kProofBytes = 5;
constexpr std::string_view kMark = "1d0f5e1f";  // the same for all: an earlier version's id ends so once in 2^32

bool is_digit(char c) {
  return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f');
}

}  // namespace

std::string make_run_id(std::string_view submitter, BytesView random) {
  Bytes claim(random);
  claim += submitter;
  return to_hex(random) + to_hex(BytesView(purpose_digest("run id", claim)).substr(0, kProofBytes)) +
         std::string(kMark);
}

Status check_run_id(std::string_view run, std::string_view submitter) {
  if (run.size() != kDigits || !std::ranges::all_of(run, is_digit)) {
    return fail(Errc::bad_value, "run '" + std::string(run.substr(0, 64)) + "' is no id",
                "use 32 lower-case hexadecimal digits");
  }
  if (!run.ends_with(kMark)) return Done{};
  const auto random = from_hex(run.substr(0, 2 * kRunIdRandom));
  if (!random) return random.error();
  if (make_run_id(submitter, *random) == run) return Done{};
  return fail(Errc::bad_value,
              "run " + std::string(run) + " is no id of '" + std::string(submitter.substr(0, 64)) + "'",
              "draw a new run id");
}

}  // namespace trb
