// libmodbus' own client against trb-virtual-plc: independent of this project's code.
#include <doctest/doctest.h>
#include <modbus.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <csignal>
#include <cstdlib>
#include <memory>
#include <string>

#include "tests/support/paths.hpp"

namespace {

constexpr const char* kAddress = "127.0.143.8";

/** The program, which ends with this object. */
class Plc {
 public:
  Plc() {
    std::array<int, 2> out{};
    REQUIRE(::pipe(out.data()) == 0);
    pid_ = ::fork();
    if (pid_ == 0) {
      ::dup2(out[1], 1);
      ::execl((trb::test::bin_dir() + "/trb-virtual-plc").c_str(), "trb-virtual-plc", "--address", kAddress, "--port",
              "auto", "--speed", "100", "--bring-boxes", "--die-with-parent", nullptr);
      ::_exit(127);
    }
    ::close(out[1]);
    stdout_ = out[0];
    port = std::atoi(line_with("ready ").substr(6).c_str());
  }
  Plc(const Plc&) = delete;
  Plc& operator=(const Plc&) = delete;
  ~Plc() {
    ::kill(pid_, SIGTERM);
    ::waitpid(pid_, nullptr, 0);
    ::close(stdout_);
  }

  /** Waits for a line that begins with this, a minute at most. */
  std::string line_with(const std::string& begin) {
    for (;;) {
      const std::size_t end = text_.find('\n');
      if (end != std::string::npos) {
        const std::string line = text_.substr(0, end);
        text_.erase(0, end + 1);
        if (line.starts_with(begin)) return line;
        continue;
      }
      pollfd entry{stdout_, POLLIN, 0};
      REQUIRE_MESSAGE(::poll(&entry, 1, 60'000) == 1, begin);
      std::array<char, 4096> buffer{};
      const ssize_t size = ::read(stdout_, buffer.data(), buffer.size());
      REQUIRE_MESSAGE(size > 0, begin);
      text_.append(buffer.data(), static_cast<std::size_t>(size));
    }
  }

  int port = 0;

 private:
  pid_t pid_ = -1;
  int stdout_ = -1;
  std::string text_;
};

struct Client {
  explicit Client(int port) : modbus(modbus_new_tcp(kAddress, port), modbus_free) {
    REQUIRE(modbus_set_response_timeout(modbus.get(), 60, 0) == 0);  // its own is half a second
    REQUIRE(modbus_connect(modbus.get()) == 0);
  }
  ~Client() { modbus_close(modbus.get()); }
  std::unique_ptr<modbus_t, void (*)(modbus_t*)> modbus;
};

}  // namespace

TEST_CASE("libmodbus reads and writes the conveyor's bits and registers") {
  Plc plc;
  Client client(plc.port);
  modbus_t* const modbus = client.modbus.get();
  std::array<std::uint8_t, 4> bits{};
  std::array<std::uint16_t, 10> registers{};
  CHECK(modbus_read_bits(modbus, 0, 2, bits.data()) == 2);
  CHECK(modbus_read_input_bits(modbus, 0, 4, bits.data()) == 4);
  CHECK(modbus_read_input_registers(modbus, 0, 10, registers.data()) == 10);
  CHECK(registers[5] == 2304);
  CHECK(modbus_write_register(modbus, 0, 800) == 1);
  CHECK(modbus_read_registers(modbus, 0, 1, registers.data()) == 1);
  CHECK(registers[0] == 800);
  const std::uint16_t speed = 900;
  CHECK(modbus_write_registers(modbus, 0, 1, &speed) == 1);
  CHECK(modbus_write_bit(modbus, 0, 1) == 1);
  plc.line_with("belt on 900");
  plc.line_with("belt off exit");
  CHECK(modbus_read_input_registers(modbus, 0, 10, registers.data()) == 10);
  CHECK(registers[0] == 2);
  CHECK(MODBUS_GET_INT32_FROM_INT16(registers.data(), 6) == 1);
  CHECK(modbus_get_float_abcd(registers.data() + 8) == 0.0F);
  CHECK(modbus_read_input_bits(modbus, 0, 1, bits.data()) == 1);
  CHECK(bits[0] == 1);
}

TEST_CASE("libmodbus understands each refusal") {
  Plc plc;
  Client client(plc.port);
  modbus_t* const modbus = client.modbus.get();
  std::array<std::uint16_t, 10> registers{};
  const auto refused = [](int result, int error) { return result == -1 && errno == error; };
  CHECK(refused(modbus_read_registers(modbus, 2, 1, registers.data()), EMBXILADD));
  CHECK(refused(modbus_write_bit(modbus, 2, 1), EMBXILADD));
  CHECK(refused(modbus_write_register(modbus, 0, 0), EMBXILVAL));
  CHECK(refused(modbus_mask_write_register(modbus, 0, 1, 1), EMBXILFUN));
  CHECK(modbus_read_registers(modbus, 0, 1, registers.data()) == 1);
}
