#include "services/cloud-gateway/io/store/test/postgres_server.hpp"

#include <doctest/doctest.h>
#include <fcntl.h>
#include <poll.h>
#include <pwd.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <pqxx/pqxx>
#include <vector>

#include "common/base/test/temporary_folder.hpp"

namespace trb::gateway::test {
namespace {

/// The newest one that is installed; empty: none.
std::string installed_programs() {
  std::vector<std::string> found;
  std::error_code none;
  for (const auto& version : std::filesystem::directory_iterator("/usr/lib/postgresql", none)) {
    if (std::filesystem::exists(version.path() / "bin/initdb")) found.push_back((version.path() / "bin").string());
  }
  std::ranges::sort(found);
  return found.empty() ? "" : found.back();
}

/// The server refuses to be root's: then it is of Debian's user for it, or nobody's.
const passwd* server_user() {
  if (::geteuid() != 0) return nullptr;
  const passwd* user = ::getpwnam("postgres");
  return user != nullptr ? user : ::getpwnam("nobody");
}

/// Runs a program as that user; what it says goes to a log. It ends with this process.
int begin(const std::vector<std::string>& words, const std::string& log) {
  const passwd* user = server_user();
  const int child = ::fork();
  REQUIRE(child >= 0);
  if (child > 0) return child;
  ::setsid();
  const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  ::dup2(out, 1);
  ::dup2(out, 2);
  if (user != nullptr && (::setgid(user->pw_gid) != 0 || ::setuid(user->pw_uid) != 0)) ::_exit(126);
  ::prctl(PR_SET_PDEATHSIG, SIGQUIT);
  std::vector<char*> given;
  for (const std::string& word : words) given.push_back(const_cast<char*>(word.c_str()));
  given.push_back(nullptr);
  ::execv(given[0], given.data());
  ::_exit(127);
}

int ended(int child) {
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  return status;
}

std::vector<int> children_of(int parent) {
  std::vector<int> found;
  for (const auto& process : std::filesystem::directory_iterator("/proc")) {
    std::ifstream file(process.path() / "stat");
    std::string id;
    std::string name;
    std::string state;
    int of = 0;
    if (file >> id >> name >> state >> of && of == parent) found.push_back(std::stoi(id));
  }
  return found;
}

/// A descriptor that can be read once the process is gone; -1: it is gone.
int process_end(int pid) {
  return static_cast<int>(::syscall(SYS_pidfd_open, pid, 0));
}

void wait_for(int process_end) {
  if (process_end < 0) return;
  pollfd end{process_end, POLLIN, 0};
  REQUIRE(::poll(&end, 1, 60'000) == 1);
  ::close(process_end);
}

std::string quoted(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' || c == '\\' ? std::string("\\") + c : std::string(1, c);
  return out + "'";
}

}  // namespace

struct PostgresHost::Folder : TemporaryFolder {
  [[nodiscard]] std::string data() const { return path + "/data"; }
  [[nodiscard]] std::string log() const { return path + "/log"; }
};

PostgresHost* PostgresHost::shared() {
  static const std::string kPrograms = installed_programs();
  if (kPrograms.empty()) {
    std::printf("skipped: PostgreSQL is not installed (apt-get install postgresql)\n");
    return nullptr;
  }
  static PostgresHost host(kPrograms);
  if (host.pid_ == 0) host.start();
  return &host;
}

PostgresHost::PostgresHost(std::string programs) : folder_(std::make_unique<Folder>()), programs_(std::move(programs)) {
  if (const passwd* user = server_user()) REQUIRE(::chown(folder_->path.c_str(), user->pw_uid, user->pw_gid) == 0);
  std::ofstream(folder_->path + "/password") << kPassword << "\n";
  const int made = begin({programs_ + "/initdb", "-D", folder_->data(), "-U", "trb", "-A", "scram-sha-256", "--pwfile",
                          folder_->path + "/password", "-E", "UTF8", "--locale=C", "--no-sync"},
                         folder_->log());
  REQUIRE_MESSAGE(ended(made) == 0, folder_->log());
}

PostgresHost::~PostgresHost() {
  if (pid_ == 0) return;
  ::kill(pid_, SIGQUIT);
  int status = 0;
  ::waitpid(pid_, &status, 0);
}

void PostgresHost::start(const std::string& setting) {
  const auto until = std::chrono::steady_clock::now() + std::chrono::seconds(60);
  do {
    REQUIRE_MESSAGE(std::chrono::steady_clock::now() < until, "the server does not answer: " << folder_->log());
    // It ends at once while a process of the one that was killed is still there.
    if (pid_ == 0 || ::waitpid(pid_, nullptr, WNOHANG) == pid_) {
      pid_ =
          begin({programs_ + "/postgres", "-D", folder_->data(), "-k", folder_->path, "-c", "listen_addresses=", "-c",
                 "shared_buffers=16MB", "-c", "fsync=off", "-c", "max_connections=30", "-c", setting},
                folder_->log());
    }
    ::poll(nullptr, 0, 50);  // it tells nobody when it is ready: it is asked
  } while (!said("SELECT 1").empty());
}

/// The children go by name: one that has not seen yet that the first process is gone would still do a commit.
void PostgresHost::kill() {
  ::kill(pid_, SIGSTOP);  // it makes no more of them
  const std::vector<int> children = children_of(pid_);
  std::vector<int> ends;
  for (const int child : children) ends.push_back(process_end(child));
  ::kill(pid_, SIGKILL);
  for (const int child : children) ::kill(child, SIGKILL);
  ended(std::exchange(pid_, 0));
  for (const int end : ends) wait_for(end);
  std::error_code none;
  std::filesystem::remove(folder_->data() + "/postmaster.pid", none);
}

void PostgresHost::stand_still(bool is_still) const {
  for (const int child : children_of(pid_)) ::kill(child, is_still ? SIGSTOP : SIGCONT);
}

PostgresServer PostgresHost::access() const {
  return {"host=" + folder_->path + " user=trb dbname=postgres password=" + quoted(kPassword),
          "postgresql:///postgres"};
}

void PostgresHost::empty() const {
  REQUIRE(said("DROP SCHEMA IF EXISTS talkrobots CASCADE") == "");
}

std::string PostgresHost::said(const std::string& sql) const {
  try {
    pqxx::connection connection(access().connection +
                                " options='-c search_path=talkrobots -c client_min_messages=error'");
    pqxx::nontransaction(connection).exec(sql);
    return "";
  } catch (const std::exception& error) {
    const std::string all(error.what());
    const std::string line = all.substr(0, all.find('\n'));
    constexpr std::string_view kBegin = "ERROR:  ";
    return line.starts_with(kBegin) ? line.substr(kBegin.size()) : line;
  }
}

std::string PostgresHost::value(const std::string& sql) const {
  pqxx::connection connection(access().connection + " options='-c search_path=talkrobots'");
  return pqxx::nontransaction(connection).exec(sql)[0][0].c_str();
}

}  // namespace trb::gateway::test
