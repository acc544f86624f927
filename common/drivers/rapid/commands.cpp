#include "common/drivers/rapid/commands.hpp"

#include <algorithm>

namespace trb::drivers {
namespace {

/// The program would answer a stop only after its move, and the service task moves nothing.
Status check_task(const std::string& subtype, const std::vector<RapidRequest>& requests) {
  const bool urgent = subtype == "stop" || subtype == "release";
  if (std::ranges::all_of(requests, [&](const RapidRequest& one) { return one.service == urgent; })) return Done{};
  return fail(Errc::bad_value,
              urgent ? "goes to the program, where it would wait for the end of a move"
                     : "goes to the service task, which moves nothing",
              urgent ? "begin it with 'service', for example \"service 91\"" : "leave 'service' out");
}

}  // namespace

RapidCommands read_rapid_commands(const VendorCommands& vendor, const Description&, const VendorFaults& faults) {
  RapidCommands out;
  for (const auto& [subtype, words] : vendor.commands) {
    auto read = read_rapid_requests(words);
    const Status fits = read ? check_task(subtype, *read) : Status(read.error());
    if (!fits) {
      faults.add("commands." + subtype, fits.error());
    } else {
      out.commands.emplace(subtype, std::move(*read));
    }
  }
  out.values = read_part("values", vendor.values, faults, read_rapid_question);
  return out;
}

}  // namespace trb::drivers
