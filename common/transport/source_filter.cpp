#include "common/transport/source_filter.hpp"

#include <arpa/inet.h>
#include <linux/filter.h>
#include <linux/sockios.h>
#include <linux/tcp.h>
#include <netinet/in.h>
#include <sys/ioctl.h>
#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace trb {
namespace {

constexpr std::size_t kPrefixBytes = 8;  ///< of IPv6: the least that one customer gets

std::string text_of(int family, const void* bytes) {
  char out[INET6_ADDRSTRLEN] = {};
  return ::inet_ntop(family, bytes, out, sizeof out) == nullptr ? "" : out;
}

RemoteEnd end_of(const sockaddr_in& from) {
  const std::string host = text_of(AF_INET, &from.sin_addr);
  return {host + ":" + std::to_string(ntohs(from.sin_port)), host};
}

RemoteEnd end_of(const sockaddr_in6& from) {
  if (IN6_IS_ADDR_V4MAPPED(&from.sin6_addr)) {
    sockaddr_in v4{};
    std::memcpy(&v4.sin_addr, &from.sin6_addr.s6_addr[12], sizeof v4.sin_addr);
    v4.sin_port = from.sin6_port;
    return end_of(v4);
  }
  in6_addr prefix{};
  std::memcpy(&prefix, &from.sin6_addr, kPrefixBytes);
  return {"[" + text_of(AF_INET6, &from.sin6_addr) + "]:" + std::to_string(ntohs(from.sin6_port)),
          text_of(AF_INET6, &prefix) + "/64"};
}

using Program = std::vector<sock_filter>;

constexpr sock_filter statement(int code, std::uint32_t k) {
  return {static_cast<std::uint16_t>(code), 0, 0, k};
}
/// Continues with the next instruction if A is k, else `past` instructions further on.
constexpr sock_filter unless_equal(std::uint32_t k, std::uint8_t past) {
  return {BPF_JMP | BPF_JEQ | BPF_K, 0, past, k};
}
constexpr sock_filter load(std::uint32_t at) {
  return statement(BPF_LD | BPF_W | BPF_ABS, static_cast<std::uint32_t>(SKF_NET_OFF) + at);
}
constexpr std::uint32_t kV4Source = 12;  // in the IP header
constexpr std::uint32_t kV6Source = 8;
constexpr std::uint32_t kKeep = 0xffffffff;

/// What happens to a new connection from each source, and from all others.
struct Verdicts {
  std::vector<std::pair<std::string, std::uint32_t>> of;
  std::uint32_t others = kKeep;
};

Program program_v4(const Verdicts& verdicts) {
  Program out{load(kV4Source)};
  for (const auto& [source, verdict] : verdicts.of) {
    in_addr address{};
    if (::inet_pton(AF_INET, source.c_str(), &address) != 1) continue;
    out.push_back(unless_equal(ntohl(address.s_addr), 1));
    out.push_back(statement(BPF_RET | BPF_K, verdict));
  }
  out.push_back(statement(BPF_RET | BPF_K, verdicts.others));
  return out;
}

Program program_v6(const Verdicts& verdicts) {
  Program out;
  for (const auto& [source, verdict] : verdicts.of) {
    in6_addr address{};
    const std::size_t slash = source.find('/');
    if (slash == std::string::npos || ::inet_pton(AF_INET6, source.substr(0, slash).c_str(), &address) != 1) continue;
    std::uint32_t words[2] = {};
    std::memcpy(words, &address, sizeof words);
    out.insert(out.end(), {load(kV6Source), unless_equal(ntohl(words[0]), 3), load(kV6Source + 4),
                           unless_equal(ntohl(words[1]), 1), statement(BPF_RET | BPF_K, verdict)});
  }
  out.push_back(statement(BPF_RET | BPF_K, verdicts.others));
  return out;
}

Program make_program(const Verdicts& verdicts) {
  const Program v4 = program_v4(verdicts);
  const Program v6 = program_v6(verdicts);
  Program out{load(0), statement(BPF_ALU | BPF_RSH | BPF_K, 28), unless_equal(6, 1),
              statement(BPF_JMP | BPF_JA, static_cast<std::uint32_t>(v4.size()))};
  out.insert(out.end(), v4.begin(), v4.end());
  out.insert(out.end(), v6.begin(), v6.end());
  return out;
}

std::vector<std::string> first_of(const std::vector<std::string>& all, std::size_t most) {
  return {all.begin(), all.begin() + static_cast<long>(std::min(all.size(), most))};
}

}  // namespace

std::optional<RemoteEnd> remote_end(int fd) {
  sockaddr_storage from{};
  socklen_t size = sizeof from;
  if (::getpeername(fd, reinterpret_cast<sockaddr*>(&from), &size) != 0) return std::nullopt;
  if (from.ss_family == AF_INET) return end_of(reinterpret_cast<const sockaddr_in&>(from));
  if (from.ss_family == AF_INET6) return end_of(reinterpret_cast<const sockaddr_in6&>(from));
  return std::nullopt;
}

std::string source_of(const std::string& address) {
  sockaddr_in v4{};
  if (::inet_pton(AF_INET, address.c_str(), &v4.sin_addr) == 1) return end_of(v4).source;
  sockaddr_in6 v6{};
  return ::inet_pton(AF_INET6, address.c_str(), &v6.sin6_addr) == 1 ? end_of(v6).source : "";
}

void cut_connection(int fd, const RemoteEnd& expected) {
  if (is_connection(fd, expected)) ::shutdown(fd, SHUT_RDWR);
}

bool is_connection(int fd, const RemoteEnd& expected) {
  const auto now = remote_end(fd);
  return now && now->address == expected.address;
}

std::optional<std::uint64_t> bytes_read(int fd) {
  tcp_info info{};
  socklen_t size = sizeof info;
  constexpr std::size_t kKnown = offsetof(tcp_info, tcpi_bytes_received) + sizeof info.tcpi_bytes_received;
  if (::getsockopt(fd, IPPROTO_TCP, TCP_INFO, &info, &size) != 0 || size < kKnown) return std::nullopt;
  // In this order: what comes or is read in between makes the result too small, or exact, but never too large.
  int waits = 0;
  if (::ioctl(fd, SIOCINQ, &waits) != 0) return std::nullopt;
  const std::uint64_t came = info.tcpi_bytes_received;
  return came - std::min(came, static_cast<std::uint64_t>(waits));
}

void SourceFilter::add_listener(int fd) {
  listeners_.insert(fd);
  if (everybody_ || !sources_.empty()) (void)attach(fd);
}

bool SourceFilter::set(const std::vector<std::string>& sources, bool everybody,
                       const std::vector<std::string>& friends) {
  sources_ = first_of(sources, kMostSources);
  friends_ = first_of(friends, kMostFriends);
  everybody_ = everybody;
  bool good = true;
  for (const int fd : listeners_) good = attach(fd) && good;
  return good;
}

/// The kernel's memory for it is small (20 kB in Debian 12): a hundred networks of IPv6 fit. Some friends are better
/// than no filter.
bool SourceFilter::attach(int fd) const {
  if (!everybody_ && sources_.empty()) {
    const int none = 0;
    return ::setsockopt(fd, SOL_SOCKET, SO_DETACH_FILTER, &none, sizeof none) == 0 || errno == ENOENT;
  }
  std::size_t friends = everybody_ ? friends_.size() : 0;
  while (!attach(fd, friends)) {
    if (friends == 0) return false;
    friends /= 2;
  }
  return true;
}

/// With the first of the friends.
bool SourceFilter::attach(int fd, std::size_t friends) const {
  Verdicts verdicts;
  for (const std::string& source : sources_) verdicts.of.emplace_back(source, 0);
  if (everybody_) verdicts.others = 0;
  for (const std::string& source : first_of(friends_, friends)) verdicts.of.emplace_back(source, kKeep);
  Program program = make_program(verdicts);
  const sock_fprog filter{static_cast<unsigned short>(program.size()), program.data()};
  return ::setsockopt(fd, SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) == 0;
}

}  // namespace trb
