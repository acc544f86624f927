#include "services/cloud-gateway/io/http/connection_table.hpp"

#include <arpa/inet.h>

#include <algorithm>

namespace trb::gateway {
namespace {

constexpr std::size_t kPrefixBytes = 8;  // a /64

std::string text_of(int family, const void* address) {
  char text[INET6_ADDRSTRLEN] = {};
  ::inet_ntop(family, address, text, sizeof text);
  return text;
}

}  // namespace

std::string source_of(std::string_view address) {
  const std::string number(address.substr(0, address.find('%')));
  in6_addr v6{};
  if (::inet_pton(AF_INET6, number.c_str(), &v6) != 1) return number;
  if (IN6_IS_ADDR_V4MAPPED(&v6)) return text_of(AF_INET, &v6.s6_addr[12]);
  std::fill(v6.s6_addr + kPrefixBytes, v6.s6_addr + sizeof v6.s6_addr, std::uint8_t{0});
  return text_of(AF_INET6, &v6) + "/64";
}

ConnectionTable::ConnectionTable(std::size_t most, std::size_t most_of_source, std::size_t most_of_proxy,
                                 const std::vector<std::string>& proxies)
    : most_(most), most_of_source_(most_of_source), most_of_proxy_(most_of_proxy) {
  for (const std::string& one : proxies) proxies_.insert(source_of(one));
}

ConnectionTable::Room ConnectionTable::room_for(const std::string& source) const {
  const auto of_source = of_source_.find(source);
  const std::size_t most = proxies_.contains(source) ? most_of_proxy_ : most_of_source_;
  if (of_source != of_source_.end() && of_source->second >= most) return Room::source_full;
  return size_ < most_ ? Room::free : Room::full;
}

void ConnectionTable::add(const std::string& source) {
  ++of_source_[source];
  ++size_;
}

void ConnectionTable::remove(const std::string& source) {
  const auto row = of_source_.find(source);
  if (row == of_source_.end()) return;
  if (--row->second == 0) of_source_.erase(row);
  --size_;
}

}  // namespace trb::gateway
