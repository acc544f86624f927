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
#include "services/router/io/worker_thread.hpp"

namespace trb::router {
namespace {

constexpr std::string_view kPrefix = "proof-";
constexpr std::string_view kSuffix = ".log";
constexpr std::uint64_t kSegmentsAtLeast = 8;
constexpr std::uint64_t kMaxSegment = 64U << 20U;
constexpr std::size_t kMaxFiles = 1024;  ///< a router that starts again and again leaves small ones
constexpr std::size_t kMaxQueued = 16U << 20U;
constexpr std::size_t kWriteAtOnce = 1U << 20U;
constexpr auto kGather = std::chrono::milliseconds(100);

}  // namespace

ProofWriter::ProofWriter(std::string dir, std::uint64_t max_bytes)
    : dir_(std::move(dir)), max_bytes_(max_bytes), segment_bytes_(std::min(max_bytes / kSegmentsAtLeast, kMaxSegment)) {
  find_segments();
  thread_ = start_without_signals([this] { run(); });
}

ProofWriter::~ProofWriter() {
  {
    const std::lock_guard lock(mutex_);
    ending_ = true;
  }
  wake_.notify_one();
  thread_.join();
  if (fd_ >= 0) ::close(fd_);
}

bool ProofWriter::put(ProofBatch&& batch) {
  bool wake = false;
  {
    const std::lock_guard lock(mutex_);
    if (queued_ + batch.records.size() > kMaxQueued) return false;
    const std::size_t before = queued_;
    queued_ += batch.records.size();
    wake = queue_.empty() || (before < kWriteAtOnce && queued_ >= kWriteAtOnce);
    queue_.push_back(std::move(batch));
  }
  if (wake) wake_.notify_one();
  return true;
}

std::string ProofWriter::take_problem() {
  const std::lock_guard lock(mutex_);
  return std::exchange(problem_, {});
}

void ProofWriter::tell(std::string problem) {
  const std::lock_guard lock(mutex_);
  problem_ = std::move(problem);
}

void ProofWriter::run() {
  std::unique_lock lock(mutex_);
  while (true) {
    wake_.wait(lock, [this] { return ending_ || !queue_.empty(); });
    if (queue_.empty()) return;
    wake_.wait_for(lock, kGather, [this] { return ending_ || queued_ >= kWriteAtOnce; });
    auto batches = std::exchange(queue_, {});
    queued_ = 0;
    lock.unlock();
    for (ProofBatch& batch : batches) write(batch);
    flush();
    lock.lock();
  }
}

void ProofWriter::write(ProofBatch& batch) {
  const std::size_t size = batch.records.size();
  const bool full = fd_ >= 0 && segments_.back().size + out_.size() + size > segment_bytes_;
  if (full) flush();
  if ((fd_ < 0 || full) && !open_segment(size)) return;
  const std::size_t from = out_.size();
  // Each segment can be read alone: it begins with the links that it goes on with.
  if (told_.insert(batch.link->link).second || batch.retell) {
    ProofLink link = *batch.link;
    link.first = batch.first;
    link.previous = batch.previous;
    append_proof_link(out_, link);
  }
  out_ += batch.records;
  finish_proof_records(out_, from);
  if (batch.last) told_.erase(batch.link->link);
  if (out_.size() >= kWriteAtOnce) flush();
}

void ProofWriter::flush() {
  if (out_.empty() || fd_ < 0) return;
  const Bytes out = std::exchange(out_, {});
  const ssize_t put = ::write(fd_, out.data(), out.size());
  if (put == static_cast<ssize_t>(out.size())) {
    segments_.back().size += out.size();
    return;
  }
  std::string problem = path_of(segments_.back().number) + ": " + (put < 0 ? std::strerror(errno) : "the disk is full");
  // No half record stays, and what comes next begins with its links again.
  if (::ftruncate(fd_, static_cast<off_t>(segments_.back().size)) != 0) problem += std::string("; ") + strerror(errno);
  told_.clear();
  tell(std::move(problem));
}

bool ProofWriter::open_segment(std::uint64_t room) {
  if (fd_ >= 0) ::close(fd_);
  fd_ = -1;
  told_.clear();
  out_.clear();
  const std::uint64_t number = segments_.empty() ? 1 : segments_.back().number + 1;
  std::uint64_t total = std::max(room, segment_bytes_);
  for (const Segment& segment : segments_) total += segment.size;
  for (; !segments_.empty() && (total > max_bytes_ || segments_.size() >= kMaxFiles); segments_.pop_front()) {
    ::unlink(path_of(segments_.front().number).c_str());
    total -= segments_.front().size;
  }
  if (Status made = make_private_dir(dir_); !made) {
    tell(made.error().text());
    return false;
  }
  const std::string path = path_of(number);
  fd_ = ::open(path.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0600);
  if (fd_ < 0) {
    tell(path + ": " + std::strerror(errno));
    return false;
  }
  segments_.push_back({number, 0});
  out_ = proof_head();
  return true;
}

std::string ProofWriter::path_of(std::uint64_t number) const {
  std::array<char, 32> digits{};
  std::snprintf(digits.data(), digits.size(), "%010llu", static_cast<unsigned long long>(number));
  return dir_ + "/" + std::string(kPrefix) + digits.data() + std::string(kSuffix);
}

void ProofWriter::find_segments() {
  std::error_code problem;
  for (const auto& entry : std::filesystem::directory_iterator(dir_, problem)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(kPrefix) || !name.ends_with(kSuffix)) continue;
    std::uint64_t number = 0;
    std::from_chars(name.data() + kPrefix.size(), name.data() + name.size() - kSuffix.size(), number);
    std::error_code none;
    const auto size = entry.file_size(none);
    if (!none && path_of(number) == dir_ + "/" + name) segments_.push_back({number, size});
  }
  std::sort(segments_.begin(), segments_.end(), [](const Segment& a, const Segment& b) { return a.number < b.number; });
}

}  // namespace trb::router
