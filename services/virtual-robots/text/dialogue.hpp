#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace trb::virtual_robots::text {

/** A robot that is asked and answers in text: requests in, answers out, without sockets. `now` is robot time in s. */
class Dialogue {
 public:
  Dialogue() = default;
  Dialogue(const Dialogue&) = delete;
  Dialogue& operator=(const Dialogue&) = delete;
  virtual ~Dialogue() = default;

  /** Removes the first whole request from the bytes. */
  virtual std::optional<std::string> take(std::string& input) const = 0;
  /** The answer to it, without its end. */
  virtual std::string answer(std::uint64_t client, const std::string& request, double now) = 0;
  virtual std::string_view end() const = 0;  ///< of an answer

  /** What it says by itself to every client. */
  virtual std::vector<std::string> advance(double /*now*/) { return {}; }
  virtual std::optional<double> next_deadline() const { return std::nullopt; }

  /** It reports an error until clear(). */
  virtual void fail(double now) = 0;
  virtual void clear() = 0;
};

/** Removes the first line from the bytes, without its end. */
std::optional<std::string> take_line(std::string& input, std::string_view end);

/** A six-axis arm of Dobot's protocol for six axes, version 4. */
std::unique_ptr<Dialogue> make_dobot();
/** A controller with lines that end with CR LF, which does nothing before a login: Epson's remote control. */
std::unique_ptr<Dialogue> make_login(std::string password);
/** A vehicle that stops once it has heard nothing for `silence` of its own seconds, and tells when it has arrived. */
std::unique_ptr<Dialogue> make_alive(double silence);

}  // namespace trb::virtual_robots::text
