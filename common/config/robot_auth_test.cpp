#include "common/config/robot_auth.hpp"

#include <doctest/doctest.h>
#include <sys/stat.h>

#include <filesystem>

#include "common/base/files.hpp"
#include "tests/support/node_folder.hpp"

using namespace trb;

TEST_CASE("how the node signs in at its robot is a secret of one line") {
  const NodeFolder folder;
  CHECK(*read_robot_auth(folder.path()) == "");
  std::filesystem::create_directories(folder.path() + "/keys");
  const std::string path = folder.path() + "/keys/robot.auth";
  const auto with = [&](const std::string& text) {
    REQUIRE(write_file(path, text));
    return read_robot_auth(folder.path());
  };
  CHECK(*with("basic Aladdin:open sesame\n") == "Basic QWxhZGRpbjpvcGVuIHNlc2FtZQ==");  // RFC 7617, section 2
  CHECK(*with("bearer mF_9.B5f-4.1JqM") == "Bearer mF_9.B5f-4.1JqM");
  CHECK(*with("digest Default User:robotics\n") == "Digest Default User:robotics");
  for (const char* bad : {"", "basic", "basic nobody", "bearer ", "bearer a b", "digest a", "digest :b", "ntlm a:b",
                          "digest a:b\nc", "basic a:b\r\nX: y\nz"}) {
    CAPTURE(bad);
    CHECK(with(bad).error().code == Errc::malformed);
  }
  ::chmod(path.c_str(), 0644);
  CHECK(read_robot_auth(folder.path()).error().code == Errc::not_permitted);
}

TEST_CASE("a sign-in that the mode-adapter could not use is a fault of its node's folder") {
  const NodeFolder folder;
  const std::string path = folder.path() + "/keys/robot.auth";
  const auto faults = [&] {
    ConfigFaults out = folder.check().faults;
    std::erase_if(out, [](const ConfigFault& fault) { return fault.file != "keys/robot.auth"; });
    return to_text(out);
  };
  folder.write("keys/robot.auth", "basic nobody:secret\n");
  CHECK(faults().empty());
  ::chmod(path.c_str(), 0644);
  CHECK(faults() == "keys/robot.auth: others may read it; chmod 600 " + path + "\n");
  folder.write("keys/robot.auth", "nobody:secret\n");
  CHECK(faults().starts_with("keys/robot.auth: is no sign-in; write one line: basic "));
  std::filesystem::remove(path);
  std::filesystem::create_directory(path);
  CHECK(faults().starts_with("keys/robot.auth: is no file; remove it"));
  CHECK(read_robot_auth(folder.path()).error().text().find("chmod") == std::string::npos);
  folder.change("node.json", R"("mode-adapter", )", "");  // nobody reads it
  CHECK(faults().empty());
}
