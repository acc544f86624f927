#include "services/ros-bridge/io/message_files.hpp"

#include <filesystem>
#include <set>

#include "common/base/files.hpp"

namespace trb::ros {
namespace {

constexpr std::size_t kMaxFile = 256U << 10U;

}  // namespace

Result<std::string> read_message_file(const std::vector<std::string>& folders, const std::string& type) {
  const std::size_t slash = type.find('/');
  std::string searched;
  for (const std::string& folder : folders) {
    const std::string path = folder + "/" + type.substr(0, slash) + "/msg/" + type.substr(slash + 1) + ".msg";
    if (file_exists(path)) return read_file(path, kMaxFile);
    searched += (searched.empty() ? "" : ", ") + folder;
  }
  return fail(Errc::missing, type + ": no definition in " + searched,
              "install the package of its messages (Debian: ros-…-msgs), or name the folder that has it");
}

std::vector<std::string> list_message_types(const std::vector<std::string>& folders) {
  std::set<std::string> types;
  for (const std::string& folder : folders) {
    std::error_code ignored;
    for (const auto& package : std::filesystem::directory_iterator(folder, ignored)) {
      for (const auto& file : std::filesystem::directory_iterator(package.path() / "msg", ignored)) {
        if (file.path().extension() != ".msg") continue;
        types.insert(package.path().filename().string() + "/" + file.path().stem().string());
      }
    }
  }
  return {types.begin(), types.end()};
}

}  // namespace trb::ros
