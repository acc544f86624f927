// The scenarios that people keep in the gateway: drafts and finished ones, as they were sent.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "common/base/bytes.hpp"
#include "common/base/result.hpp"
#include "common/base/time.hpp"
#include "services/cloud-gateway/core/access/change_list.hpp"
#include "services/cloud-gateway/core/access/hash.hpp"

namespace trb::gateway {

constexpr std::size_t kMaxScenarios = 500;
constexpr std::size_t kMaxScenarioSize = 256U << 10U;
constexpr std::size_t kMaxScenarioSizes = 32U << 20U;  ///< of all together

/// The text of a scenario, and what lists show of it.
struct ScenarioText {
  Bytes text;  ///< a JSON object, byte by byte as it was sent
  std::string name;
  std::uint32_t tasks = 0;  ///< how many
  bool operator==(const ScenarioText&) const = default;
};

/// Checks the outline alone: an object with a name and a list of tasks. It may have faults besides, for somebody still
/// works on it. Errors: malformed, too_large, missing, bad_value; the text names the member.
Result<ScenarioText> read_draft(Bytes text);

struct StoredScenario {
  std::string id;  ///< 16 hexadecimal digits
  ScenarioText scenario;
  std::uint64_t version = 1;
  std::string by;  ///< who changed it last
  UtcTime changed;
  bool operator==(const StoredScenario&) const = default;
};

/// - | added   | version 1
/// n | changed | version n + 1
/// n | removed | gone; its id never comes again
class ScenarioShelf {
 public:
  explicit ScenarioShelf(RandomBytes random) : random_(std::move(random)) {}

  /// Takes a row from the store; adds no change.
  void restore(StoredScenario scenario);

  /// Errors: queue_full (too many, or too large together).
  Result<const StoredScenario*> add(ScenarioText scenario, std::string by, UtcTime now);
  /// Errors: missing, queue_full.
  Result<const StoredScenario*> change(const std::string& id, ScenarioText scenario, std::string by, UtcTime now);
  /// Errors: missing.
  Status remove(const std::string& id);

  [[nodiscard]] const StoredScenario* find(const std::string& id) const;
  /// By id.
  [[nodiscard]] const std::map<std::string, StoredScenario>& all() const { return scenarios_; }
  std::vector<Change<StoredScenario>> take_changes() { return changes_.take(); }

 private:
  /// Is there room for this instead of so many bytes?
  [[nodiscard]] Status check_room(const ScenarioText& scenario, std::size_t instead_of) const;
  const StoredScenario* put(StoredScenario scenario);

  RandomBytes random_;
  std::map<std::string, StoredScenario> scenarios_;
  std::size_t size_ = 0;  ///< of all texts
  ChangeList<StoredScenario> changes_;
};

}  // namespace trb::gateway
