#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "services/virtual-robots/ur/rtde_values.hpp"

namespace trb::virtual_robots::ur {

/** Which client may write which input: one at a time. */
class RtdeClaims {
 public:
  /** Owner 0: nobody. */
  std::uint64_t owner_of(const std::string& name) const {
    const auto found = owners_.find(name);
    return found == owners_.end() ? 0 : found->second;
  }
  void claim(const std::string& name, std::uint64_t owner) { owners_[name] = owner; }
  void release(std::uint64_t owner) {
    std::erase_if(owners_, [&](const auto& entry) { return entry.second == owner; });
  }

 private:
  std::map<std::string, std::uint64_t> owners_;
};

/**
 * One client of the real-time data exchange, as the maker's RTDE guide describes it: packages of `uint16 size, uint8
 * type` with the size of the whole.
 *
 * package               | answer
 * ----------------------|------------------------------------------------------------------------------
 * V protocol version    | accepted: 1 or 2; without it 1 is spoken
 * v control version     | major, minor, bug fix, build
 * M text                | none; it is kept for stdout
 * O outputs             | types, NOT_FOUND among them; in version 2 the recipe's id before them, 0: not valid
 * I inputs              | id and types; NOT_FOUND or IN_USE among them: id 0, nothing is claimed
 * S start, P pause      | accepted; a start needs a valid recipe
 * U data                | none; an input that cannot be taken is answered by a text
 * any other             | a text
 */
class RtdeSession {
 public:
  static constexpr double kFastest = 500;  ///< packages a second
  static constexpr std::size_t kLongestNames = 2048;
  static constexpr std::size_t kMostRecipes = 255;

  RtdeSession(std::uint64_t id, RtdeClaims& claims) : id_(id), claims_(claims) {}
  RtdeSession(const RtdeSession&) = delete;
  RtdeSession& operator=(const RtdeSession&) = delete;
  ~RtdeSession() { claims_.release(id_); }

  /** Takes whole packages from the front of `input`; returns the answers. `time` is real, in seconds. */
  std::string take(std::string& input, RtdeWritten& written, double time);

  /** A package's border is lost: the client must be dropped. */
  bool broken() const { return broken_; }
  /** True once after inputs were written. */
  bool take_changes() { return std::exchange(changed_, false); }
  std::vector<std::string> take_texts() { return std::exchange(texts_, {}); }

  /** When the next data package is due, in real time; nothing while paused. */
  std::optional<double> next_due() const { return started_ && outputs_ ? std::optional(due_) : std::nullopt; }
  /** The data package, if it is due. After a long pause the missed ones are not sent all at once. */
  std::string data(const RtdePicture& picture, double time);

 private:
  struct Outputs {
    std::vector<RtdeOutput> fields;
    double period = 1 / kFastest;
  };

  std::string answer(std::uint8_t type, std::string_view body, RtdeWritten& written, double time);
  std::string negotiate(std::string_view body);
  std::string set_outputs(std::string_view body);
  std::string set_inputs(std::string_view body);
  std::string start(double time);
  std::string take_data(std::string_view body, RtdeWritten& written);
  std::string keep_text(std::string_view body);
  std::string complaint(std::string_view text) const;

  std::uint64_t id_;
  RtdeClaims& claims_;
  int version_ = 1;
  std::optional<Outputs> outputs_;
  std::vector<std::vector<RtdeInput>> recipes_;
  bool started_ = false;
  bool broken_ = false;
  bool changed_ = false;
  double due_ = 0;
  std::vector<std::string> texts_;
};

}  // namespace trb::virtual_robots::ur
