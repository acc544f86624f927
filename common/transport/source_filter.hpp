// Beside libzmq, on its own descriptors: who is at the other end, ending one accepted connection, and keeping sources
// out before there is a connection. libzmq has none of the three.
#pragma once

#include <optional>
#include <set>
#include <string>
#include <vector>

namespace trb {

/// The other end of a TCP connection.
struct RemoteEnd {
  std::string address;  ///< "192.168.1.7" or "2001:db8::7", with :PORT behind it: names the connection
  std::string source;   ///< who is counted: an IPv4 address, or the first 64 bits of an IPv6 address as "2001:db8::/64"
};

/// RemoteEnd::source of an address; empty for what is none.
std::string source_of(const std::string& address);

/// Nothing if the descriptor is no TCP connection (any more).
std::optional<RemoteEnd> remote_end(int fd);

/// Ends the connection of a descriptor that libzmq owns: libzmq sees it closed by the other side. Does nothing if the
/// descriptor is another connection by now.
void cut_connection(int fd, const RemoteEnd& expected);

/// Drops the packets that would make a new connection, in the kernel, so that a flood costs neither descriptors nor
/// wake-ups. Connections that are there are left alone. Linux (a classic BPF filter on the listening sockets).
class SourceFilter {
 public:
  static constexpr std::size_t kMostSources = 64;
  static constexpr std::size_t kMostFriends = 256;

  void add_listener(int fd);
  void remove_listener(int fd) { listeners_.erase(fd); }
  /// Replaces what was set before: drops these sources, at most kMostSources; or everybody but these friends, at most
  /// kMostFriends, who are sources, too. False if the kernel refused it.
  bool set(const std::vector<std::string>& sources, bool everybody, const std::vector<std::string>& friends = {});

 private:
  [[nodiscard]] bool attach(int fd) const;
  std::set<int> listeners_;
  std::vector<std::string> sources_;
  std::vector<std::string> friends_;
  bool everybody_ = false;
};

}  // namespace trb
