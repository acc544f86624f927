// Makes of a robot's fields what they say: an acknowledgement, a confirmation, a message of its own.
#pragma once

#include <map>
#include <optional>
#include <string>

#include "common/fleet/description.hpp"

namespace trb::cli::conform {

/// A robot's message, in words; the target is empty for its own node.
struct Said {
  std::string type, subtype, target, data;
};

struct Received {
  enum class Kind : std::uint8_t { ok, stopped, released, said, closed, silence, nonsense };
  Kind kind{};
  Said said;
  std::string text;  ///< of nonsense: what is wrong with it
};

/// The words of the channel, or their numbers.
class Words {
 public:
  Words(const FieldChannel& channel, std::string own_id);

  [[nodiscard]] bool numeric() const { return channel_.encoding == Encoding::numeric; }
  /// The field for a type, a subtype or an id; nothing without a number for it.
  [[nodiscard]] std::optional<std::string> type(const std::string& word) const;
  [[nodiscard]] std::optional<std::string> subtype(const std::string& word) const;
  [[nodiscard]] std::optional<std::string> id(const std::string& word) const;
  // And back.
  [[nodiscard]] std::optional<std::string> type_of(const std::string& field) const;
  [[nodiscard]] std::optional<std::string> subtype_of(const std::string& field) const;
  [[nodiscard]] std::optional<std::string> id_of(const std::string& field) const;
  [[nodiscard]] std::string ok() const { return numeric() ? "0" : "ok"; }
  [[nodiscard]] std::string stop() const { return numeric() ? "-1" : "!stop"; }
  [[nodiscard]] std::string release() const { return numeric() ? "-2" : "!release"; }
  [[nodiscard]] std::string stopped() const { return numeric() ? "-1" : "!stopped"; }
  [[nodiscard]] std::string released() const { return numeric() ? "-2" : "!released"; }
  [[nodiscard]] std::string unknown() const { return numeric() ? "0" : "unknown"; }

 private:
  const FieldChannel& channel_;
  std::string own_id_;
};

class Collector {
 public:
  Collector(const Words& words, bool delayed) : words_(words), delayed_(delayed) {}

  /// What is whole with this field.
  std::optional<Received> take(const std::string& field);
  void restart();
  /// The fields of a message that are there; 0 between two messages.
  [[nodiscard]] std::size_t fields() const { return fields_; }

 private:
  std::optional<Received> begin(const std::string& field);
  std::optional<Received> take_size(const std::string& field);
  std::optional<Received> finish();

  const Words& words_;
  bool delayed_;
  Said said_;
  std::size_t fields_ = 0;
  std::size_t size_ = 0;
};

}  // namespace trb::cli::conform
