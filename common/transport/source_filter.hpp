// What libzmq cannot do, on its own descriptors: find out who is at the other end and how much has come from there, end
// one connection, and block sources before a connection exists.
#pragma once

#include <cstdint>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace trb {

/// The other end of a TCP connection.
struct RemoteEnd {
  std::string address;  ///< "192.168.1.7" or "2001:db8::7", with :PORT behind it: names the connection
  std::string source;   ///< the unit that is counted: an IPv4 address, or the first 64 bits of an IPv6 address as
                        ///< "2001:db8::/64"
};

/// RemoteEnd::source of an address; empty for an invalid one.
std::string source_of(const std::string& address);

/// Empty if the descriptor is not (or no longer) a TCP connection.
std::optional<RemoteEnd> remote_end(int fd);

/// Is this still that connection's descriptor?
bool is_connection(int fd, const RemoteEnd& expected);

/// How many bytes libzmq has read of a TCP connection since it was made; what waits in the kernel does not count. Empty
/// if the descriptor is not (or no longer) a TCP connection, or the kernel does not say (before Linux 4.1).
std::optional<std::uint64_t> bytes_read(int fd);

/// Ends the connection of a descriptor that libzmq owns: to libzmq the other side has closed it. Does nothing if the
/// descriptor belongs to another connection by now.
void cut_connection(int fd, const RemoteEnd& expected);

/// Drops the packets that would open a new connection, in the kernel, so that a flood costs neither descriptors nor
/// wake-ups. Existing connections are not affected. Linux (a classic BPF filter on the listening sockets).
class SourceFilter {
 public:
  static constexpr std::size_t kMostSources = 64;
  static constexpr std::size_t kMostFriends = 256;

  void add_listener(int fd);
  void remove_listener(int fd) { listeners_.erase(fd); }
  /// Replaces the earlier setting: drops these sources, at most kMostSources; or all except these friends, at most
  /// kMostFriends, which are sources, too; fewer, if the kernel has no room for all. False if the kernel refused it.
  bool set(const std::vector<std::string>& sources, bool everybody, const std::vector<std::string>& friends = {});

 private:
  [[nodiscard]] bool attach(int fd) const;
  [[nodiscard]] bool attach(int fd, std::size_t friends) const;
  std::set<int> listeners_;
  std::vector<std::string> sources_;
  std::vector<std::string> friends_;
  bool everybody_ = false;
};

}  // namespace trb
