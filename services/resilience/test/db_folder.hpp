// A capability database in a folder of its own.
#pragma once

#include <doctest/doctest.h>
#include <stdlib.h>

#include <filesystem>
#include <memory>
#include <string>

#include "services/resilience/io/capability_db.hpp"
#include "services/resilience/test/fleet_fixture.hpp"

namespace trb::resilience::test {

struct Folder {
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "trb-capability-XXXXXX").string();
    REQUIRE(::mkdtemp(name.data()) != nullptr);
    path = name;
  }
  ~Folder() { std::filesystem::remove_all(path); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  [[nodiscard]] std::string file() const { return path + "/capability.db"; }
  std::string path;
};

inline std::unique_ptr<CapabilityDb> opened(const Folder& folder) {
  auto db = CapabilityDb::open(folder.file());
  REQUIRE_MESSAGE(db.ok(), (db ? "" : db.error().text()));
  return std::move(*db);
}

inline Fleet loaded(CapabilityDb& db) {
  Fleet fleet;
  const Status done = db.load(fleet);
  CHECK_MESSAGE(done.ok(), (done ? "" : done.error().text()));
  return fleet;
}

}  // namespace trb::resilience::test
