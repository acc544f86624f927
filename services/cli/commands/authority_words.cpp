#include "services/cli/commands/authority_words.hpp"

#include "common/base/hex.hpp"

namespace trb::cli {
namespace {

constexpr std::size_t kKeySize = 32;

}  // namespace

Result<FleetAuthority> authority_of(const Arguments& arguments) {
  if (arguments.has("--key")) {
    auto key = from_hex(arguments.get("--key"));
    if (!key || key->size() != kKeySize) {
      return fail(Errc::bad_value, "--key: needs 64 hexadecimal digits",
                  "copy the authority key that trb fleet show FLEET_DIR prints");
    }
    return FleetAuthority{"", std::move(*key)};
  }
  if (!arguments.has("--fleet")) {
    return fail(Errc::missing, "whose proof is to be believed?",
                "give --fleet FLEET_DIR, or --key with the authority key that trb fleet show prints");
  }
  std::string dir = arguments.get("--fleet");
  constexpr std::string_view kFile = "fleet.json";
  if (dir.ends_with(kFile)) dir.resize(dir.size() - kFile.size());
  return read_fleet(dir.empty() ? "." : dir);
}

}  // namespace trb::cli
