// A target without libFuzzer: writes its seeds, or feeds them and random mutations of them, the same ones at each run.
//   NAME [--inputs N] [--seed N] [--write-seeds DIR] [FILE...]
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <random>
#include <string>

#include "tests/fuzz/target.hpp"

namespace {

using trb::Bytes;
using Random = std::mt19937_64;

std::size_t below(Random& random, std::size_t end) {
  return end == 0 ? 0 : random() % end;
}

/// One to eight changes: bits, bytes, numbers at their limits, pieces left out, doubled or taken from another seed.
Bytes mutate(Bytes input, const std::vector<Bytes>& seeds, Random& random) {
  for (std::size_t i = 0, changes = 1 + below(random, 8); i < changes; ++i) {
    const std::size_t at = below(random, input.size() + 1);
    const std::size_t size = below(random, std::min<std::size_t>(input.size() - at, 32) + 1);
    switch (below(random, 6)) {
      case 0:
        if (at < input.size()) input[at] = static_cast<char>(input[at] ^ (1 << below(random, 8)));
        break;
      case 1:
        if (at < input.size()) input[at] = static_cast<char>("\x00\x7f\x80\xff\xdd\xc6"[below(random, 6)]);
        break;
      case 2:
        input.erase(at, size);
        break;
      case 3:
        input.insert(at, input.substr(at, size));
        break;
      case 4:
        input.insert(at, 1 + below(random, 8), static_cast<char>(random()));
        break;
      default: {
        const Bytes& other = seeds[below(random, seeds.size())];
        input = input.substr(0, at) + other.substr(below(random, other.size() + 1));
      }
    }
  }
  return input;
}

int write_seeds(const std::string& dir) {
  std::size_t number = 0;
  for (const Bytes& seed : trb::fuzz::seeds()) {
    std::ofstream(dir + "/seed-" + std::to_string(number++), std::ios::binary) << seed;
  }
  std::printf("%zu seeds\n", number);
  return 0;
}

int run_file(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file) {
    std::fprintf(stderr, "%s: cannot be read\n", path.c_str());
    return 2;
  }
  trb::fuzz::run(Bytes(std::istreambuf_iterator<char>(file), {}));
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  std::uint64_t inputs = 20'000;
  std::uint64_t seed = 1;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--write-seeds" && has_value) return write_seeds(argv[++i]);
    if (word == "--inputs" && has_value) {
      inputs = std::strtoull(argv[++i], nullptr, 10);
    } else if (word == "--seed" && has_value) {
      seed = std::strtoull(argv[++i], nullptr, 10);
    } else {
      return run_file(word);
    }
  }
  const std::vector<Bytes> seeds = trb::fuzz::seeds();
  for (const Bytes& one : seeds) trb::fuzz::run(one);
  Random random(seed);
  for (std::uint64_t i = 0; i < inputs; ++i) trb::fuzz::run(mutate(seeds[below(random, seeds.size())], seeds, random));
  std::printf("%zu seeds and %llu mutations of them: no crash, no broken invariant\n", seeds.size(),
              static_cast<unsigned long long>(inputs));
  return 0;
}
