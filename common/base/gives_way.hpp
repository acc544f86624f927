// Bounded places that many share: whoever has the most of them gives way, so that nobody takes the others' places.
#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace trb {

/// Who gives up a place for one more of `asking`: whoever would have the most then; `asking`, if nobody has more.
template <class Places, class Owner>
std::string gives_way(Places&& places, std::string_view asking, const Owner& owner_of) {
  std::map<std::string, std::size_t, std::less<>> counts{{std::string(asking), 1}};
  for (const auto& place : places) ++counts[std::invoke(owner_of, place)];
  std::string out(asking);
  for (const auto& [owner, count] : counts) {
    if (count > counts.find(out)->second) out = owner;
  }
  return out;
}

}  // namespace trb
