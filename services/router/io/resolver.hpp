// Resolves the hosts that node.json names as seeds, on a thread of its own: a silent name server blocks that thread for
// a minute, and nothing else.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "common/base/result.hpp"
#include "common/base/time.hpp"

namespace trb::router {

constexpr std::size_t kMaxNames = 256;                       ///< hosts, and so waiting requests
constexpr Duration kNameKept = std::chrono::minutes(1);      ///< then it is resolved again
constexpr Duration kNamePatience = std::chrono::seconds(1);  ///< before a missing answer is reported

/// The host's numeric addresses, the best first; reads /etc/hosts, queries the name server, and blocks meanwhile.
/// Errors: missing: there is no such host; timeout: no server answered.
Result<std::vector<std::string>> look_up_host(const std::string& host);

class Resolver {
 public:
  using Lookup = std::function<Result<std::vector<std::string>>(const std::string& host)>;

  explicit Resolver(Lookup lookup = look_up_host);
  ~Resolver();  ///< does not wait for a pending request
  Resolver(const Resolver&) = delete;
  Resolver& operator=(const Resolver&) = delete;

  struct Found {
    std::string address;  ///< HOST:PORT in numbers; empty while it is not known
    std::string row;      ///< why it is not known, for people; empty while the answer is awaited
  };
  /// Of HOST:PORT with a name. Never waits; starts a request if nothing is known, or the answer is old.
  Found find(const std::string& address, MonotonicTime now);
  /// A dial to this host has ended: the next of its addresses is tried, and the name is resolved again. The old answer
  /// is used until the new one comes.
  void ended(const std::string& address, MonotonicTime now);

 private:
  struct Name {
    std::vector<std::string> hosts;
    std::size_t next = 0;  ///< the index of the one to use
    std::string failure;
    std::optional<MonotonicTime> requested;  ///< when, while the request waits
    std::optional<MonotonicTime> until;      ///< then it is resolved again
  };
  /// Outlives this object while a request is pending.
  struct Shared {
    Lookup lookup;
    std::mutex mutex;
    std::condition_variable wake;
    std::map<std::string, Name> names;
    std::deque<std::string> requests;
    bool ending = false;
    bool started = false;
  };
  static void run(const std::shared_ptr<Shared>& shared);
  static void take(Name& name, Result<std::vector<std::string>> found);
  void request(const std::string& host, Name& name, MonotonicTime now);

  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

}  // namespace trb::router
