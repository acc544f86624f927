#include "services/cli/io/passphrase.hpp"

#include <termios.h>
#include <unistd.h>

#include <array>
#include <csignal>
#include <cstdlib>
#include <iostream>

#include "common/base/files.hpp"

namespace trb::cli {
namespace {

constexpr std::array kEnding{SIGINT, SIGTERM, SIGHUP, SIGQUIT};

termios shown;  ///< the terminal as it was: a signal's handler has nowhere else to find it

/// Then the signal does what it would have done: the handler is its first one alone.
void show_and_end(int signal) {
  ::tcsetattr(STDIN_FILENO, TCSANOW, &shown);
  ::raise(signal);
}

/// While it exists the terminal does not show what is typed. A signal that ends the program restores it.
class Unshown {
 public:
  Unshown() : terminal_(::tcgetattr(STDIN_FILENO, &shown) == 0) {
    if (!terminal_) return;
    struct sigaction show {};
    show.sa_handler = show_and_end;
    show.sa_flags = static_cast<int>(SA_RESETHAND);
    for (std::size_t i = 0; i < kEnding.size(); ++i) {
      ::sigaction(kEnding[i], nullptr, &before_[i]);
      if (before_[i].sa_handler != SIG_IGN) ::sigaction(kEnding[i], &show, nullptr);
    }
    termios silent = shown;
    silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
  }
  ~Unshown() {
    if (!terminal_) return;
    ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &shown);
    for (std::size_t i = 0; i < kEnding.size(); ++i) ::sigaction(kEnding[i], &before_[i], nullptr);
  }
  Unshown(const Unshown&) = delete;
  Unshown& operator=(const Unshown&) = delete;

 private:
  bool terminal_;
  std::array<struct sigaction, kEnding.size()> before_{};
};

/// A typed line that the terminal does not show.
std::string ask_passphrase(const std::string& prompt) {
  std::cerr << prompt << ": " << std::flush;
  std::string line;
  {
    const Unshown unshown;
    std::getline(std::cin, line);
  }
  std::cerr << "\n";
  return line;
}

}  // namespace

Result<std::string> ask_for_passphrase(const Arguments& arguments, bool fresh, const std::string& what) {
  if (arguments.has("--passphrase-file")) {
    auto text = read_file(arguments.get("--passphrase-file"), 4096);
    if (!text) return fail(text.error().code, text.error().what, "name a file whose first line is the passphrase");
    return text->substr(0, text->find('\n'));
  }
  if (const char* set = std::getenv("TRB_PASSPHRASE")) return std::string(set);
  if (::isatty(STDIN_FILENO) != 1) {
    return fail(Errc::missing, "no passphrase",
                "give --passphrase-file FILE, or set TRB_PASSPHRASE, or use a terminal");
  }
  std::string first = ask_passphrase(what);
  if (fresh && ask_passphrase("once more") != first)
    return fail(Errc::bad_value, "the two passphrases differ", "try again");
  return first;
}

}  // namespace trb::cli
