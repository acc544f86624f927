// What a connection of the bus has requested, and from whom: only that party's answer is accepted.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

namespace trb::router {

/// Who may answer: a peer or a connection of the own bus, by a number that is never reused.
enum class Party : std::uint64_t { nobody = 0 };

constexpr Party party_of_peer(std::uint64_t number) {
  return static_cast<Party>(number << 1U);
}
constexpr Party party_of_connection(std::uint64_t number) {
  return static_cast<Party>(number << 1U | 1U);
}

/// A table of fixed size, indexed by the lower bits of an id: a newer entry replaces an older one. An entry stays after
/// the first answer: streams have many. Its memory is allocated in pages, on use.
template <std::size_t kPages>
class RequestTable {
 public:
  struct Entry {
    std::uint64_t id = 0;
    Party whom = Party::nobody;
  };
  static constexpr std::size_t kPageSize = 1024;
  static constexpr std::size_t kSize = kPages * kPageSize;

  void note(const Entry& entry) {
    auto& page = pages_[page_of(entry.id)];
    if (!page) page = std::make_unique<std::array<Entry, kPageSize>>();
    (*page)[entry.id % kPageSize] = entry;
  }
  /// Null if it is not known (any more).
  [[nodiscard]] const Entry* find(std::uint64_t id) const {
    const auto& page = pages_[page_of(id)];
    const Entry* entry = page ? &(*page)[id % kPageSize] : nullptr;
    return entry != nullptr && entry->id == id ? entry : nullptr;
  }

 private:
  static std::size_t page_of(std::uint64_t id) { return id / kPageSize % kPages; }
  std::array<std::unique_ptr<std::array<Entry, kPageSize>>, kPages> pages_;
};

/// The requests of one connection.
class SentRequests {
 public:
  static constexpr std::size_t kRequests = 32 * 1024;
  static constexpr std::size_t kInformations = 4 * 1024;

  /// A command or request has left, or (`wants_answer` false) a user's information: to that only a Nack may come back,
  /// and a flood of it removes no requests.
  void note(std::uint64_t id, bool wants_answer, Party whom);
  /// May `from` answer the message `id`?
  [[nodiscard]] bool may_answer(std::uint64_t id, bool nack, Party from) const;

 private:
  RequestTable<kRequests / 1024> requests_;
  RequestTable<kInformations / 1024> informations_;
};

}  // namespace trb::router
