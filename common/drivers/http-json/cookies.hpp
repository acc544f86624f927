// The cookies that a robot has given: it knows the session by them, and begins another one for each request without.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace trb::drivers {

class CookieJar {
 public:
  static constexpr std::size_t kMost = 8;
  static constexpr std::size_t kMaxSize = 4096;  ///< of one, with its name

  /// Set-Cookie's values. A cookie without a value, or with Max-Age=0, is removed; path, domain and end are not kept:
  /// there is one robot. What is malformed, too large or one too many is left out.
  void take(const std::vector<std::string>& values);
  /// The value of Cookie; empty: there is none.
  [[nodiscard]] std::string header() const;
  void clear() { cookies_.clear(); }
  [[nodiscard]] std::size_t size() const { return cookies_.size(); }

 private:
  void take_one(const std::string& value);

  std::vector<std::pair<std::string, std::string>> cookies_;
};

}  // namespace trb::drivers
