// Every message type that Debian ships: its sum, and random messages bit for bit through JSON and back.
//   test_ros_types            the test
//   test_ros_types --sums     "TYPE MD5" a line, for comparison with another implementation
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <random>

#include "common/base/hex.hpp"
#include "services/ros-bridge/core/message_codec.hpp"
#include "services/ros-bridge/core/wire_bytes.hpp"
#include "services/ros-bridge/io/message_files.hpp"

using namespace trb;
using namespace trb::ros;

namespace {

const std::vector<std::string> kFolders = {"/usr/share"};
constexpr int kMessages = 20;

using Random = std::mt19937_64;

void put_random(Bytes& out, const RosType& type, Random& random);

template <class T, class Bits>
void put_real(Bytes& out, Random& random) {
  auto bits = static_cast<Bits>(random());
  // What is not finite does not come back: it is told as null, and refused.
  if (!std::isfinite(std::bit_cast<T>(bits))) bits = std::bit_cast<Bits>(std::numeric_limits<T>::lowest());
  put_little(out, bits);
}

void put_random(Bytes& out, const Field& field, Random& random) {
  switch (field.primitive) {
    case Primitive::none:
      return put_random(out, *field.message, random);
    case Primitive::boolean:
      return out.push_back(static_cast<char>(random() % 2));
    case Primitive::int8:
    case Primitive::uint8:
      return out.push_back(static_cast<char>(random()));
    case Primitive::int16:
    case Primitive::uint16:
      return put_little(out, static_cast<std::uint16_t>(random()));
    case Primitive::int32:
    case Primitive::uint32:
      return put_little(out, static_cast<std::uint32_t>(random()));
    case Primitive::float32:
      return put_real<float, std::uint32_t>(out, random);
    case Primitive::float64:
      return put_real<double, std::uint64_t>(out, random);
    case Primitive::string: {
      const auto size = static_cast<std::uint32_t>(random() % 9);
      put_little(out, size);
      for (std::uint32_t i = 0; i < size; ++i) out.push_back(static_cast<char>(random()));
      return;
    }
    default:
      return put_little(out, static_cast<std::uint64_t>(random()));
  }
}

void put_random(Bytes& out, const RosType& type, Random& random) {
  for (const Field& field : type.fields) {
    std::uint32_t count = 1;
    if (field.array) count = field.length ? *field.length : static_cast<std::uint32_t>(random() % 4);
    if (field.array && !field.length) put_little(out, count);
    for (std::uint32_t i = 0; i < count; ++i) put_random(out, field, random);
  }
}

/// Empty if the message comes back as it was.
std::string round_trip(const RosType& type, const Bytes& wire) {
  const auto json = to_json(type, wire);
  if (!json) return json.error().text();
  const auto text = parse_json(dump_json(*json));
  if (!text) return text.error().text();
  const auto again = to_wire(type, *text);
  if (!again) return again.error().text();
  return *again == wire ? "" : "other bytes: " + to_hex(wire) + " became " + to_hex(*again);
}

}  // namespace

int main(int argc, char** argv) {
  const bool sums = argc > 1 && std::strcmp(argv[1], "--sums") == 0;
  TypeStore store([](const std::string& type) { return read_message_file(kFolders, type); });
  Random random(1);
  int faults = 0;
  const std::vector<std::string> types = list_message_types(kFolders);
  if (types.empty()) {
    std::printf("skipped: no message definition in /usr/share; install ros-std-msgs and others\n");
    return 77;
  }
  for (const std::string& name : types) {
    const auto type = store.find(name);
    if (!type) {
      std::printf("%s: %s\n", name.c_str(), type.error().text().c_str());
      ++faults;
      continue;
    }
    if (sums) {
      std::printf("%s %s\n", name.c_str(), (*type)->md5.c_str());
      continue;
    }
    for (int i = 0; i < kMessages; ++i) {
      Bytes wire;
      put_random(wire, **type, random);
      const std::string fault = round_trip(**type, wire);
      if (fault.empty()) continue;
      std::printf("%s: %s\n", name.c_str(), fault.c_str());
      ++faults;
      break;
    }
  }
  if (!sums) {
    std::printf("%zu message types, %d random messages each, bit for bit through JSON: %d faults\n", types.size(),
                kMessages, faults);
  }
  return faults == 0 ? 0 : 1;
}
