#include <doctest/doctest.h>
#include <fcntl.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "common/base/address.hpp"
#include "common/base/config_fault.hpp"
#include "common/base/descriptor.hpp"
#include "common/base/files.hpp"
#include "common/base/hex.hpp"
#include "common/base/ids.hpp"
#include "common/base/printable.hpp"
#include "common/base/saturate.hpp"
#include "common/base/test/closed_folder.hpp"
#include "common/base/test/temporary_folder.hpp"
#include "common/base/time.hpp"

using namespace trb;

TEST_CASE("a pipe in a file's place keeps nobody waiting; one that somebody writes to is read to its end") {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/certificate.json";
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  const auto none = read_file(path);
  REQUIRE_FALSE(none);
  CHECK(none.error().code == Errc::io_error);
  CHECK(none.error().what == path + ": is a pipe, and nothing comes out of it");
  CHECK_FALSE(none.error().hint.empty());

  int ends[2];
  REQUIRE(::pipe(ends) == 0);
  std::thread writer([&] {
    CHECK(::write(ends[1], "first ", 6) == 6);
    CHECK(::write(ends[1], "second", 6) == 6);
    ::close(ends[1]);
  });
  const auto text = read_file("/dev/fd/" + std::to_string(ends[0]));
  writer.join();
  ::close(ends[0]);
  REQUIRE(text);
  CHECK(*text == "first second");
}

TEST_CASE("a pipe in a file's place that somebody holds open, and writes nothing to, keeps nobody waiting either") {
  const TemporaryFolder folder;
  const std::string path = folder.path + "/fleet.json";
  REQUIRE(::mkfifo(path.c_str(), 0600) == 0);
  const Descriptor holder(::open(path.c_str(), O_RDWR | O_CLOEXEC));
  REQUIRE(holder);
  const auto none = read_file(path);
  REQUIRE_FALSE(none);
  CHECK(none.error().what == path + ": is a pipe, and nothing comes out of it");
  REQUIRE(::write(holder.get(), "half", 4) == 4);
  CHECK(read_file(path).error().what == path + ": is a pipe, and its end does not come");
  const std::string unread = folder.path + "/boot";
  REQUIRE(::mkfifo(unread.c_str(), 0600) == 0);
  CHECK(overwrite_file(unread, "1").error().code == Errc::io_error);
}

TEST_CASE("hexadecimal goes there and back, and refuses what is none") {
  CHECK(to_hex(std::string("\x00\xff\x10", 3)) == "00ff10");
  CHECK(*from_hex("00FF10") == std::string("\x00\xff\x10", 3));
  CHECK(from_hex("0").error().code == Errc::malformed);
  CHECK(from_hex("0g").error().code == Errc::malformed);
}

TEST_CASE("text of others cannot command a terminal, and is the same text in JSON") {
  CHECK(printable("a robot\n\t\u00e9 \u20ac") == "a robot\n\t\u00e9 \u20ac");
  CHECK(printable("\x1b]0;owned\x07") == "\\u001b]0;owned\\u0007");
  CHECK(printable("\xc2\x9b"
                  "31m\x7f\r") == "\\u009b31m\\u007f\\u000d");
  CHECK(printable(std::string_view("\0\xc2", 2)) == "\\u0000\xc2");
}

TEST_CASE("text of others begins no line and no column of its own") {
  CHECK(in_one_line("ur3\r\nur5\tONLINE \x1b[2m") == "ur3\\u000d\\u000aur5\\u0009ONLINE \x1b[2m");
  CHECK(to_text({{"s.json", "tasks[0]\nx", "no robot 'a\nb'", "one\nof"}}) ==
        "s.json: tasks[0]\\u000ax: no robot 'a\\u000ab'; one\\u000aof\n");
}

TEST_CASE("an id is short, lower-case and starts with a letter") {
  CHECK(is_valid_id("ur3"));
  CHECK(is_valid_id("pioneer-1_b"));
  for (const char* bad : {"", "3ur", "UR3", "a b", "a/b", "*"}) CHECK_FALSE(is_valid_id(bad));
  CHECK_FALSE(is_valid_id(std::string(65, 'a')));
  CHECK(is_valid_word("goTo"));
  CHECK(check_id("node.json: id", "A").error().text().find("node.json: id") != std::string::npos);
}

TEST_CASE("UTC prints as ISO 8601") {
  CHECK(to_iso8601({0}) == "1970-01-01T00:00:00.000Z");
  CHECK(to_iso8601({1'772'366'400'250'000'000}) == "2026-03-01T12:00:00.250Z");
  CHECK(to_iso8601({-1'000'000}) == "1969-12-31T23:59:59.999Z");
}

TEST_CASE("the earlier deadline wins, none loses") {
  CHECK(earlier(std::nullopt, MonotonicTime{5})->ns == 5);
  CHECK(earlier(MonotonicTime{4}, MonotonicTime{5})->ns == 4);
  CHECK_FALSE(earlier(std::nullopt, std::nullopt));
}

TEST_CASE("an error names its code, its field and its cure") {
  CHECK(fail(Errc::missing, "node.json: id", "add it").text() == "missing: node.json: id; add it");
}

TEST_CASE("an address is numbers and a port; a name, half an address and what ends a line are none") {
  for (const char* good : {"10.0.0.1:1", "127.0.0.1:65535", "[::1]:45000", "[fd00::1]:45000", "[fe80::1%eth0]:45000"})
    CHECK_MESSAGE(is_numeric_endpoint(good), good);
  using namespace std::string_view_literals;
  for (const std::string_view bad : {""sv,
                                     ":"sv,
                                     "localhost:1"sv,
                                     "a.b:45000"sv,
                                     "10.0.0.1"sv,
                                     "10.0.0.1:"sv,
                                     "10.0.0.1:0"sv,
                                     "10.0.0.1:65536"sv,
                                     "10.0.0.1:-1"sv,
                                     "10.0.0.1:+1"sv,
                                     "10.0.0.1: 1"sv,
                                     "10.0.1:1"sv,
                                     "10.1:1"sv,
                                     "167772161:1"sv,
                                     "0x0a000001:1"sv,
                                     "010.0.0.1:1"sv,
                                     "10.0.0.1 :1"sv,
                                     "10.0.0.1\0x:1"sv,
                                     "::1:1"sv,
                                     "[::1:1"sv,
                                     "::1]:1"sv,
                                     "[]:1"sv,
                                     "[hub]:1"sv,
                                     "[10.0.0.1]:1"sv,
                                     "[fe80::1%]:1"sv,
                                     "[fe80::1%a b]:1"sv,
                                     "[fe80::1%\n]:1"sv,
                                     "[fe80::1%x/y]:1"sv,
                                     "[fe80::1%0123456789abcdef]:1"sv,
                                     "*:1"sv,
                                     "10.0.0.1:1\n"sv,
                                     "tcp://10.0.0.1:1"sv})
    CHECK_MESSAGE(!is_numeric_endpoint(bad), bad);
}

TEST_CASE("sums of what others have chosen stay in their range") {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  constexpr std::int64_t kLeast = std::numeric_limits<std::int64_t>::min();
  CHECK(saturating_add(kMost, 1) == kMost);
  CHECK(saturating_add(kLeast, -1) == kLeast);
  CHECK(saturating_add(kMost, kLeast) == -1);
  CHECK(saturating_sub(kMost, -1) == kMost);
  CHECK(saturating_sub(kLeast, 1) == kLeast);
  CHECK(saturating_sub(0, kLeast) == kMost);
  CHECK(saturating_sub(7, 9) == -2);
}

namespace {

using Folder = TemporaryFolder;

unsigned mode_of(const std::string& path) {
  struct stat facts {};
  REQUIRE(::lstat(path.c_str(), &facts) == 0);
  return facts.st_mode & 0777U;
}

}  // namespace

TEST_CASE("what somebody has put where a file is made is not written into") {
  Folder folder;
  const std::string path = folder.path + "/file";
  const std::string beside = path + ".new" + std::to_string(::getpid());
  std::ofstream(folder.path + "/elsewhere") << "theirs";
  for (const bool link : {true, false}) {
    if (link) std::filesystem::create_symlink("elsewhere", beside);
    if (!link) std::filesystem::create_hard_link(folder.path + "/elsewhere", beside);
    REQUIRE(write_file(path, "secret"));
    CHECK(*read_file(folder.path + "/elsewhere") == "theirs");
    CHECK(*read_file(path) == "secret");
    CHECK(mode_of(path) == 0600);
    CHECK_FALSE(file_exists(beside));
  }
}

TEST_CASE("a file that cannot be replaced stays whole, and nothing of the new one is left") {
  Folder folder;
  const std::string path = folder.path + "/file";
  std::filesystem::create_directories(path + "/in-the-way");
  CHECK(write_file(path, "new").error().code == Errc::io_error);
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path), {}) == 1);
  CHECK(write_file(folder.path + "/none/file", "new").error().code == Errc::io_error);
  CHECK(write_file("/dev/full/file", "new").error().code == Errc::io_error);
}

TEST_CASE("what a writer that was killed has left goes, once no writer can be at it, and nothing else does") {
  namespace fs = std::filesystem;
  const Folder folder;
  const auto put = [&](const std::string& name, std::chrono::minutes age) {
    std::ofstream(folder.path + "/" + name) << "half";
    fs::last_write_time(folder.path + "/" + name, fs::file_time_type::clock::now() - age);
  };
  using std::chrono::minutes;
  for (const char* name : {"identity.key.new4711", "utc.new1"}) put(name, minutes(11));
  for (const char* name : {"identity.key", "plan.new", "plan.new2b", "brand.newer1", ".new12"}) put(name, minutes(11));
  put("link.key.new4711", minutes(9));
  fs::create_directory(folder.path + "/folder.new7");
  fs::create_symlink("identity.key", folder.path + "/link.new8");
  remove_unfinished_files(folder.path);
  std::vector<std::string> left;
  for (const auto& entry : fs::directory_iterator(folder.path)) left.push_back(entry.path().filename().string());
  std::sort(left.begin(), left.end());
  CHECK(left == std::vector<std::string>{".new12", "brand.newer1", "folder.new7", "identity.key", "link.key.new4711",
                                         "link.new8", "plan.new", "plan.new2b"});
  remove_unfinished_files(folder.path + "/none");
}

TEST_CASE("a file is written over in place, not made, and a disk that is full is told") {
  Folder folder;
  const std::string path = folder.path + "/number";
  CHECK(overwrite_file(path, "1").error().code == Errc::missing);
  CHECK_FALSE(file_exists(path));
  REQUIRE(write_file(path, "0001\n"));
  REQUIRE(overwrite_file(path, "0002\n"));
  CHECK(*read_file(path) == "0002\n");
  CHECK(overwrite_file("/dev/full", "1").error().code == Errc::io_error);
}

TEST_CASE("a private folder, and all that is or comes to be in it, is its user's alone") {
  Folder folder;
  const std::string log = folder.path + "/log";
  const std::string outside = folder.path + "/outside";
  ::umask(022);
  std::filesystem::create_directories(log + "/proof");
  std::ofstream(log + "/old.log") << "words";
  std::ofstream(log + "/proof/1") << "words";
  std::ofstream(outside) << "words";
  std::filesystem::create_symlink(outside, log + "/link");
  CHECK(mode_of(log + "/old.log") == 0644);
  REQUIRE(make_private_dir(log));
  CHECK(mode_of(log) == 0700);
  CHECK(mode_of(log + "/proof") == 0700);
  CHECK(mode_of(log + "/old.log") == 0600);
  CHECK(mode_of(log + "/proof/1") == 0600);
  CHECK(mode_of(outside) == 0644);
  std::ofstream(log + "/new.log") << "words";
  CHECK(mode_of(log + "/new.log") == 0600);
  CHECK(make_private_dir(outside + "/log").error().code == Errc::io_error);
  ::umask(022);
}

TEST_CASE("a folder that may not be looked into is told as such, and not as missing") {
  Folder folder;
  const std::string inner = folder.path + "/inner";
  REQUIRE(make_dir(inner));
  REQUIRE(write_file(inner + "/file", "words"));
  CHECK(look_for(inner + "/file").ok());
  CHECK(look_for(inner + "/none").error().code == Errc::missing);
  CHECK(look_for(inner + "/file/none").error().code == Errc::missing);
  const ClosedFolder closed(folder.path);
  const auto is_told = [](const Error& why) {
    CAPTURE(why.text());
    CHECK(why.code == Errc::io_error);
    CHECK(why.what.ends_with(": Permission denied"));
    CHECK(why.hint.find("run it as the user of the services") == 0);
  };
  is_told(look_for(inner + "/file").error());
  is_told(read_file(inner + "/file").error());
  is_told(write_file(inner + "/file", "new").error());
  is_told(make_dir(inner + "/further").error());
  is_told(make_private_dir(inner + "/further").error());
  ::umask(022);
}
