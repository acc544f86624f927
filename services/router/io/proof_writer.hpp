// The thread that writes log/proof, so that no disk ever holds a message up.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "common/security/proof.hpp"

namespace trb::router {

/// Records of one link, cut where a seal ends.
struct ProofBatch {
  std::shared_ptr<const ProofLink> link;  ///< its two certificates
  std::uint64_t first = 1;                ///< where the records go on, for a file that begins with them
  Bytes previous;
  Bytes records;        ///< as append_proof_*() makes them
  bool retell = false;  ///< what was before is not in the log
  bool last = false;    ///< the link is over
};

/// Segments proof-0000000001.log, -0000000002.log ... in a folder, mode 0600, never more than `max_bytes` in all: the
/// oldest go. What comes within a tenth of a second is one write.
class ProofWriter {
 public:
  ProofWriter(std::string dir, std::uint64_t max_bytes);
  /// Writes what is left.
  ~ProofWriter();
  ProofWriter(const ProofWriter&) = delete;
  ProofWriter& operator=(const ProofWriter&) = delete;

  /// Never waits for the disk. False: too much is waiting for it already; the batch is gone.
  bool put(ProofBatch&& batch);
  /// What could not be written since the last call: the reason, or empty.
  std::string take_problem();

 private:
  struct Segment {
    std::uint64_t number = 0;
    std::uint64_t size = 0;
  };
  void run();
  void write(ProofBatch& batch);
  void flush();
  bool open_segment(std::uint64_t room);
  void find_segments();
  void tell(std::string problem);
  [[nodiscard]] std::string path_of(std::uint64_t number) const;

  const std::string dir_;
  const std::uint64_t max_bytes_;
  const std::uint64_t segment_bytes_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<ProofBatch> queue_;  ///< this and the next three under the mutex; all below is the thread's alone
  std::size_t queued_ = 0;
  std::string problem_;
  bool ending_ = false;

  std::deque<Segment> segments_;  ///< the last one is written to while fd_ is open
  int fd_ = -1;
  Bytes out_;                     ///< for the last segment, not yet written
  std::set<std::uint64_t> told_;  ///< links that the last segment knows
  std::thread thread_;
};

}  // namespace trb::router
