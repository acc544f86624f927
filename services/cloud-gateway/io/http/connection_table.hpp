// How many connections there are, and from where. Pure.
#pragma once

#include <map>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace trb::gateway {

/// By what clients are told apart: an IPv4 address; for IPv6 the /64 ("2001:db8::/64"), for one machine may take any
/// address of it; an IPv4-mapped address as IPv4. `address`: a number, a scope ("%eth0") is dropped. What is none stays
/// as it is.
std::string source_of(std::string_view address);

class ConnectionTable {
 public:
  /// `proxies`: addresses whose connections are those of many people.
  ConnectionTable(std::size_t most, std::size_t most_of_source, std::size_t most_of_proxy = 0,
                  const std::vector<std::string>& proxies = {});

  enum class Room { free, full, source_full };
  /// Is there room for one more? `source_full` comes first: to close a connection of another source would not help.
  [[nodiscard]] Room room_for(const std::string& source) const;
  void add(const std::string& source);
  void remove(const std::string& source);
  [[nodiscard]] std::size_t size() const { return size_; }

 private:
  std::size_t most_;
  std::size_t most_of_source_;
  std::size_t most_of_proxy_;
  std::set<std::string> proxies_;  ///< as sources
  std::size_t size_ = 0;
  std::map<std::string, std::size_t> of_source_;
};

}  // namespace trb::gateway
