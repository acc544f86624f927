#include "services/cli/io/passphrase.hpp"

#include <termios.h>
#include <unistd.h>

#include <cstdlib>
#include <iostream>

#include "common/base/files.hpp"

namespace trb::cli {
namespace {

/// A typed line that the terminal does not show.
std::string ask_passphrase(const std::string& prompt) {
  termios before{};
  const bool terminal = ::tcgetattr(STDIN_FILENO, &before) == 0;
  termios silent = before;
  silent.c_lflag &= ~static_cast<tcflag_t>(ECHO);
  std::cerr << prompt << ": " << std::flush;
  if (terminal) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &silent);
  std::string line;
  std::getline(std::cin, line);
  if (terminal) ::tcsetattr(STDIN_FILENO, TCSAFLUSH, &before);
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
