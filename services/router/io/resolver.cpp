#include "services/router/io/resolver.hpp"

#include <netdb.h>
#include <sys/socket.h>

#include <algorithm>
#include <array>
#include <memory>
#include <thread>

#include "services/router/io/worker_thread.hpp"

namespace trb::router {
namespace {

constexpr const char* kCure = "look at /etc/hosts and /etc/resolv.conf, or name the seed in node.json by its numbers";

std::string host_of(const std::string& address) {
  return address.substr(0, address.rfind(':'));
}

std::string with_port(const std::string& host, const std::string& address) {
  const bool ipv6 = host.find(':') != std::string::npos;
  return (ipv6 ? "[" + host + "]" : host) + address.substr(address.rfind(':'));
}

}  // namespace

Result<std::vector<std::string>> look_up_host(const std::string& host) {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_ADDRCONFIG;
  addrinfo* list = nullptr;
  const int problem = ::getaddrinfo(host.c_str(), nullptr, &hints, &list);
  if (problem == EAI_AGAIN || problem == EAI_SYSTEM || problem == EAI_MEMORY)
    return fail(Errc::timeout, "the name server does not answer for " + host, kCure);
  if (problem != 0) return fail(Errc::missing, "there is no host " + host + ": " + ::gai_strerror(problem), kCure);
  const std::unique_ptr<addrinfo, decltype(&::freeaddrinfo)> owner(list, ::freeaddrinfo);
  std::vector<std::string> out;
  for (const addrinfo* entry = list; entry != nullptr; entry = entry->ai_next) {
    std::array<char, NI_MAXHOST> text{};
    const bool told =
        ::getnameinfo(entry->ai_addr, entry->ai_addrlen, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) == 0;
    if (told && std::find(out.begin(), out.end(), text.data()) == out.end()) out.emplace_back(text.data());
  }
  if (out.empty()) return fail(Errc::missing, host + " has no address", kCure);
  return out;
}

Resolver::Resolver(Lookup lookup) {
  shared_->lookup = std::move(lookup);
}

Resolver::~Resolver() {
  {
    const std::lock_guard lock(shared_->mutex);
    shared_->ending = true;
  }
  shared_->wake.notify_one();
}

Resolver::Found Resolver::find(const std::string& address, MonotonicTime now) {
  const std::string host = host_of(address);
  const std::lock_guard lock(shared_->mutex);
  const auto known = shared_->names.find(host);
  if (known == shared_->names.end() && shared_->names.size() >= kMaxNames)
    return {"", "over " + std::to_string(kMaxNames) + " host names are asked for: name seeds by their numbers"};
  Name& name = known == shared_->names.end() ? shared_->names[host] : known->second;
  if (!name.until || now >= *name.until) request(host, name, now);
  if (!name.hosts.empty()) return {with_port(name.hosts[name.next % name.hosts.size()], address), ""};
  if (!name.failure.empty()) return {"", name.failure};
  const bool silent = name.requested && now - *name.requested >= kNamePatience;
  return {"", silent ? "the name server has not answered for " + host + " yet: " + kCure : ""};
}

void Resolver::ended(const std::string& address, MonotonicTime now) {
  const std::string host = host_of(address);
  const std::lock_guard lock(shared_->mutex);
  const auto known = shared_->names.find(host);
  if (known == shared_->names.end()) return;
  ++known->second.next;
  request(host, known->second, now);
}

void Resolver::request(const std::string& host, Name& name, MonotonicTime now) {
  if (name.requested) return;
  name.requested = now;
  name.until = now + kNameKept;
  shared_->requests.push_back(host);
  shared_->wake.notify_one();
  if (shared_->started) return;
  shared_->started = true;  // a node without such a seed has no such thread
  start_without_signals([shared = shared_] { run(shared); }).detach();
}

void Resolver::run(const std::shared_ptr<Shared>& shared) {
  std::unique_lock lock(shared->mutex);
  for (;;) {
    shared->wake.wait(lock, [&] { return shared->ending || !shared->requests.empty(); });
    if (shared->ending) return;
    const std::string host = std::move(shared->requests.front());
    shared->requests.pop_front();
    lock.unlock();
    auto found = shared->lookup(host);
    lock.lock();
    take(shared->names[host], std::move(found));
  }
}

void Resolver::take(Name& name, Result<std::vector<std::string>> found) {
  name.requested.reset();
  name.failure.clear();
  if (found) {
    // If the addresses are the same, keep the current one.
    if (name.hosts != *found) name.next = 0;
    name.hosts = std::move(*found);
    return;
  }
  name.failure = found.error().what + ": " + found.error().hint;
  name.until.reset();  // resolved again at the next dial
  if (found.error().code == Errc::missing) name.hosts.clear();
}

}  // namespace trb::router
