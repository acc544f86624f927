#include "common/actor/route_pages.hpp"

#include <iterator>
#include <utility>

namespace trb {
namespace {

constexpr std::size_t kMostRows = 4096;  ///< more than any router has

}  // namespace

RoutePages::Taken RoutePages::take(RouteTable page) {
  if (page.after.empty()) {
    table_ = {};
    table_.gathers = page.gathers;
    after_.clear();
  } else if (page.after != after_) {
    return {};
  }
  const std::string last = page.routes.empty() ? std::string() : page.routes.back().id;
  const bool goes_on = page.more && !last.empty() && last != after_ && table_.routes.size() < kMostRows;
  table_.node = std::move(page.node);
  table_.routes.insert(table_.routes.end(), std::make_move_iterator(page.routes.begin()),
                       std::make_move_iterator(page.routes.end()));
  after_ = goes_on ? last : std::string();
  if (goes_on) return {.whole = {}, .next = RouteListRequest{last}};
  return {.whole = std::exchange(table_, {}), .next = {}};
}

}  // namespace trb
