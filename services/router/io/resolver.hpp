// Where the hosts are that node.json names as seeds. The question waits on a thread of its own: a name server that is
// silent holds it for a minute, and nothing else.
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

constexpr std::size_t kMaxNames = 256;                       ///< hosts, and so questions that wait
constexpr Duration kNameKept = std::chrono::minutes(1);      ///< then it is asked for again
constexpr Duration kNamePatience = std::chrono::seconds(1);  ///< before a question without an answer is told of

/// The host's addresses in numbers, the best first; asks /etc/hosts and the name server, and takes its time. Errors:
/// missing, there is no such host; timeout, nobody said.
Result<std::vector<std::string>> look_up_host(const std::string& host);

class Resolver {
 public:
  using Lookup = std::function<Result<std::vector<std::string>>(const std::string& host)>;

  explicit Resolver(Lookup lookup = look_up_host);
  ~Resolver();  ///< a question under way is left behind
  Resolver(const Resolver&) = delete;
  Resolver& operator=(const Resolver&) = delete;

  struct Found {
    std::string address;  ///< HOST:PORT in numbers; empty while it is not known
    std::string row;      ///< why not, for people; empty while the answer may be on its way
  };
  /// Of HOST:PORT with a name. Never waits; asks if nothing is known, or what is known is old.
  Found find(const std::string& address, MonotonicTime now);
  /// A dial to what was found has ended: its next address is tried, and the name is asked for again. What was found
  /// before is used until that is answered.
  void ended(const std::string& address, MonotonicTime now);

 private:
  struct Name {
    std::vector<std::string> hosts;
    std::size_t next = 0;  ///< of them
    std::string failure;
    std::optional<MonotonicTime> asked;  ///< while the question waits
    std::optional<MonotonicTime> until;  ///< then it is asked for again
  };
  /// Outlives this object while a question is under way.
  struct Shared {
    Lookup lookup;
    std::mutex mutex;
    std::condition_variable wake;
    std::map<std::string, Name> names;
    std::deque<std::string> questions;
    bool ending = false;
    bool started = false;
  };
  static void run(const std::shared_ptr<Shared>& shared);
  static void take(Name& name, Result<std::vector<std::string>> found);
  void ask(const std::string& host, Name& name, MonotonicTime now);

  std::shared_ptr<Shared> shared_ = std::make_shared<Shared>();
};

}  // namespace trb::router
