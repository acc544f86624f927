// A capability database in a folder of its own.
#pragma once

#include <doctest/doctest.h>
#include <stdlib.h>

#include <filesystem>
#include <memory>
#include <string>

#include "common/base/test/temporary_folder.hpp"
#include "services/resilience/io/capability_db.hpp"
#include "services/resilience/test/fleet_fixture.hpp"

namespace trb::resilience::test {

struct Folder : TemporaryFolder {
  [[nodiscard]] std::string file() const { return path + "/capability.db"; }
};

inline std::unique_ptr<CapabilityDb> opened(const Folder& folder) {
  auto db = CapabilityDb::open(folder.file());
  REQUIRE_MESSAGE(db.ok(), (db ? "" : db.error().text()));
  return std::move(*db);
}

/// A fleet and the database that it is written to.
struct KeptFleet {
  Folder folder;
  std::unique_ptr<CapabilityDb> db = opened(folder);
  Fleet fleet;

  void add(const std::string& id, const NodeProfile& profile) {
    REQUIRE(fleet.on_route(route_of(id, profile), at_second(0)));
  }
};

inline Fleet loaded(CapabilityDb& db) {
  Fleet fleet;
  const Status done = db.load(fleet);
  CHECK_MESSAGE(done.ok(), (done ? "" : done.error().text()));
  return fleet;
}

}  // namespace trb::resilience::test
