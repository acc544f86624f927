#include "services/router/io/proof_writer.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <utility>

#include "common/base/files.hpp"
#include "common/base/ids.hpp"
#include "services/router/io/worker_thread.hpp"

namespace trb::router {
namespace {

constexpr std::string_view kPrefix = "proof-";
constexpr std::string_view kSuffix = ".log";
/// The smallest segment is small: in 64 MB a thousand peers have one each.
constexpr std::uint64_t kSegments = 1024;
/// A peer with many bytes has large segments: files are made and removed seldom, and a removal costs it a sixteenth.
constexpr std::uint64_t kSegmentsOfPeer = 16;
constexpr std::uint64_t kMostSegment = 64U << 20U;  ///< a reader has it in memory: the start, trb proof
constexpr std::uint64_t kLeastSegment = 64U << 10U;
/// A router that starts again and again leaves small segments: each counts as at least this part of a whole one, so
/// that their number is bounded too.
constexpr std::uint64_t kLeastPart = 8;
constexpr std::size_t kMaxQueuedBytes = 16U << 20U;
constexpr std::size_t kWriteAtOnce = 1U << 20U;
constexpr std::size_t kMaxMended = 80U << 20U;  ///< the largest segment, plus a range
constexpr auto kGather = std::chrono::milliseconds(100);

std::string problem_with(const std::string& path, ssize_t put) {
  return path + ": " + (put < 0 ? std::strerror(errno) : "the disk is full");
}

}  // namespace

ProofWriter::ProofWriter(std::string dir, std::uint64_t max_bytes)
    : dir_(std::move(dir)),
      max_bytes_(max_bytes),
      segment_bytes_(std::clamp(max_bytes / kSegments, kLeastSegment, kMostSegment)) {
  thread_ = start_without_signals([this] { run(); });
}

ProofWriter::~ProofWriter() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_one();
  thread_.join();
}

bool ProofWriter::put(ProofBatch&& batch) {
  bool wake = false;
  {
    const std::lock_guard lock(mutex_);
    const std::size_t size = batch.records.size();
    std::size_t& of_peer = queued_of_[batch.peer];
    if (of_peer + size > kMaxQueuedBytes - queued_) return false;
    const std::size_t before = queued_;
    of_peer += size;
    queued_ += size;
    wake = queue_.empty() || (before < kWriteAtOnce && queued_ >= kWriteAtOnce);
    queue_.push_back(std::move(batch));
  }
  if (wake) wake_.notify_one();
  return true;
}

std::uint64_t ProofWriter::take_dropped() {
  const std::lock_guard lock(mutex_);
  return std::exchange(dropped_, 0);
}

std::string ProofWriter::take_problem() {
  const std::lock_guard lock(mutex_);
  return std::exchange(problem_, {});
}

void ProofWriter::set_problem(std::string problem) {
  const std::lock_guard lock(mutex_);
  problem_ = std::move(problem);
}

void ProofWriter::run() {
  find_segments();
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return ending_ || !queue_.empty(); });
    if (queue_.empty()) return;
    wake_.wait_for(lock, kGather, [this] { return ending_ || queued_ >= kWriteAtOnce; });
    auto batches = std::exchange(queue_, {});
    queued_ = 0;
    queued_of_.clear();
    lock.unlock();
    for (ProofBatch& batch : batches) write(batch);
    flush_all();
    lock.lock();
  }
}

void ProofWriter::write(ProofBatch& batch) {
  const auto at = peers_.try_emplace(batch.peer).first;
  Peer& peer = at->second;
  if (peer.open && peer.segments.back().size + batch.records.size() > peer.segment_bytes) {
    flush(at);
    peer.open = false;
  }
  Bytes beginning;
  if (!find_room(at, batch, beginning)) {
    peer.told.erase(batch.link->link);
    const std::lock_guard lock(mutex_);
    dropped_ += batch.frames;
    return;
  }
  if (!peer.open) open_segment(peer);
  peer.told.insert(batch.link->link);
  if (batch.last) peer.told.erase(batch.link->link);
  add_records(peer, beginning, batch);
  if (unwritten_ >= kWriteAtOnce) flush_all();
}

/// Makes room for the batch and the `beginning` that it needs. Its peer's own last segment may have to go: then it
/// needs another beginning.
bool ProofWriter::find_room(Peers::iterator at, const ProofBatch& batch, Bytes& beginning) {
  const Peer& peer = at->second;
  bool was_open = false;
  do {
    was_open = peer.open;
    beginning = beginning_of(peer, batch);
    if (!make_room(at, beginning.size() + batch.records.size())) return false;
  } while (was_open && !peer.open);
  return true;
}

void ProofWriter::open_segment(Peer& peer) {
  peer.segment_bytes = std::clamp(peer.cost / kSegmentsOfPeer, segment_bytes_, kMostSegment);
  peer.segments.push_back({next_number_++, 0});
  peer.cost += cost_of(peer.segments.back());
  cost_ += cost_of(peer.segments.back());
  peer.open = true;
  peer.written = 0;
  peer.told.clear();
}

void ProofWriter::add_records(Peer& peer, const Bytes& beginning, const ProofBatch& batch) {
  const std::size_t from = peer.out.size() + (peer.segments.back().size == 0 ? proof_head().size() : 0);
  peer.out += beginning;
  peer.out += batch.records;
  finish_proof_records(peer.out, from);
  resize_last(peer, peer.segments.back().size + beginning.size() + batch.records.size());
  unwritten_ += beginning.size() + batch.records.size();
}

/// What must precede its records, in its peer's last segment or in a new one. Each segment can be read alone: it begins
/// with the links that it continues.
Bytes ProofWriter::beginning_of(const Peer& peer, const ProofBatch& batch) {
  Bytes out = peer.open ? Bytes() : proof_head();
  if (!peer.open || batch.retell || peer.told.count(batch.link->link) == 0) {
    ProofLink link = *batch.link;
    link.first = batch.first;
    link.previous = batch.previous;
    append_proof_link(out, link);
  }
  return out;
}

std::uint64_t ProofWriter::cost_of(const Segment& segment) const {
  return std::max(segment.size, segment_bytes_ / kLeastPart);
}

void ProofWriter::resize_last(Peer& peer, std::uint64_t size) {
  Segment& last = peer.segments.back();
  const std::uint64_t before = cost_of(last);
  last.size = size;
  peer.cost += cost_of(last) - before;
  cost_ += cost_of(last) - before;
}

/// False: it does not fit even if all the peer's segments go, and the others have less than it would have.
bool ProofWriter::make_room(Peers::iterator peer, std::uint64_t bytes) {
  const std::uint64_t needed = bytes + segment_bytes_ / kLeastPart;
  while (cost_ + needed > max_bytes_) {
    auto most = peer;
    std::uint64_t cost = peer->second.cost + needed;
    for (auto at = peers_.begin(); at != peers_.end(); ++at) {
      if (at->second.cost <= cost) continue;
      most = at;
      cost = at->second.cost;
    }
    if (most->second.segments.empty()) return false;
    remove_oldest(most);
  }
  return true;
}

void ProofWriter::remove_oldest(Peers::iterator at) {
  Peer& peer = at->second;
  const Segment oldest = peer.segments.front();
  peer.segments.pop_front();
  peer.cost -= cost_of(oldest);
  cost_ -= cost_of(oldest);
  if (peer.segments.empty() && peer.open) {
    unwritten_ -= peer.out.size();
    peer.out.clear();
    peer.open = false;
  }
  ::unlink(path_of(at->first, oldest.number).c_str());
}

void ProofWriter::remove_last(Peers::iterator at) {
  Peer& peer = at->second;
  peer.cost -= cost_of(peer.segments.back());
  cost_ -= cost_of(peer.segments.back());
  ::unlink(path_of(at->first, peer.segments.back().number).c_str());
  peer.segments.pop_back();
}

void ProofWriter::flush_all() {
  for (auto at = peers_.begin(); at != peers_.end();) {
    flush(at);
    at = at->second.segments.empty() ? peers_.erase(at) : std::next(at);
  }
}

void ProofWriter::flush(Peers::iterator at) {
  Peer& peer = at->second;
  if (peer.out.empty()) return;
  unwritten_ -= peer.out.size();
  const std::string problem = append(at);
  if (problem.empty()) {
    peer.written += peer.out.size();
    peer.out.clear();
    return;
  }
  // The next batch begins with its links again.
  peer.out.clear();
  peer.open = false;
  resize_last(peer, peer.written);
  if (peer.written == 0) remove_last(at);
  set_problem(problem);
}

/// Opened for each write: a thousand peers then need no thousand descriptors. Returns what failed; then nothing of it
/// is in the file.
std::string ProofWriter::append(Peers::const_iterator at) {
  const Peer& peer = at->second;
  const std::string path = path_of(at->first, peer.segments.back().number);
  if (peer.written == 0) {
    if (Status made = make_private_dir(dir_); !made) return made.error().text();
  }
  const int flags = O_WRONLY | O_APPEND | O_CLOEXEC | (peer.written == 0 ? O_CREAT | O_EXCL : 0);
  const int fd = ::open(path.c_str(), flags, 0600);
  if (fd < 0) return problem_with(path, -1);
  std::string problem;
  const ssize_t put = ::write(fd, peer.out.data(), peer.out.size());
  if (put != static_cast<ssize_t>(peer.out.size())) {
    problem = problem_with(path, put);
    if (::ftruncate(fd, static_cast<off_t>(peer.written)) != 0) problem += std::string("; ") + std::strerror(errno);
  }
  ::close(fd);
  return problem;
}

/// A router of an earlier version wrote one series of segments for all peers: no peer in the name.
std::string ProofWriter::path_of(const std::string& peer, std::uint64_t number) const {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%010llu", static_cast<unsigned long long>(number));
  return dir_ + "/" + std::string(kPrefix) + digits.data() + (peer.empty() ? "" : "-" + peer) + std::string(kSuffix);
}

void ProofWriter::find_segments() {
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(dir_, problem)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) continue;
    const char* end = name.data() + name.size() - kSuffix.size();
    std::uint64_t number = 0;
    const char* after = std::from_chars(name.data() + kPrefix.size(), end, number).ptr;
    const std::string peer(after == end ? after : after + 1, end);
    std::error_code none;
    const auto size = entry.file_size(none);
    if (none || path_of(peer, number) != dir_ + "/" + name) continue;
    peers_[peer].segments.push_back({number, size});
    next_number_ = std::max(next_number_, number + 1);
  }
  for (auto at = peers_.begin(); at != peers_.end(); ++at) {
    Peer& peer = at->second;
    std::sort(peer.segments.begin(), peer.segments.end(),
              [](const Segment& a, const Segment& b) { return a.number < b.number; });
    for (const Segment& segment : peer.segments) peer.cost += cost_of(segment);
    cost_ += peer.cost;
    mend_last(at);
  }
}

/// A router that was killed while writing may have left half a record.
void ProofWriter::mend_last(Peers::iterator at) {
  Peer& peer = at->second;
  const std::string path = path_of(at->first, peer.segments.back().number);
  const auto file = read_file(path, kMaxMended);
  if (!file) return;
  const std::size_t whole = whole_proof_records(*file);
  if (whole == file->size() || ::truncate(path.c_str(), static_cast<off_t>(whole)) != 0) return;
  resize_last(peer, whole);
  if (whole == 0) remove_last(at);
}

}  // namespace trb::router
