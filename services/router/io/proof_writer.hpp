// The thread that writes log/proof, so that a disk never delays a message.
#pragma once

#include <condition_variable>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>
#include <thread>

#include "common/security/proof.hpp"

namespace trb::router {

/// Records of one link, ending at a seal.
struct ProofBatch {
  std::string peer;                       ///< the link's peer: an id
  std::shared_ptr<const ProofLink> link;  ///< its two certificates
  std::uint64_t first = 1;                ///< the first sequence number, for a file that begins with them
  Bytes previous;
  Bytes records;             ///< as append_proof_*() makes them
  std::uint64_t frames = 0;  ///< in `records`
  bool retell = false;       ///< earlier records are missing in the log
  bool last = false;         ///< the link has ended
};

/// Segments proof-0000000001-PEER.log, proof-0000000002-OTHER.log ... in a folder, mode 0600, never more than
/// `max_bytes` in all. Each peer has segments of its own. When room is needed, the oldest segment of the peer with the
/// most bytes is removed, so a peer within its share of the whole loses nothing, whatever the others send. What comes
/// within a tenth of a second is one write per peer.
class ProofWriter {
 public:
  ProofWriter(std::string dir, std::uint64_t max_bytes);
  /// Writes what is left.
  ~ProofWriter();
  ProofWriter(const ProofWriter&) = delete;
  ProofWriter& operator=(const ProofWriter&) = delete;

  /// Never waits for the disk. False: too much is waiting already, of this peer or of all; the batch is dropped. A peer
  /// may have as much waiting as it leaves free for the others.
  bool put(ProofBatch&& batch);
  /// Frames that were accepted and are not on the disk, since the last call.
  std::uint64_t take_dropped();
  /// Why something could not be written since the last call; empty: nothing failed.
  std::string take_problem();

 private:
  struct Segment {
    std::uint64_t number = 0;
    std::uint64_t size = 0;  ///< including what is not written yet
  };
  struct Peer {
    std::deque<Segment> segments;
    std::uint64_t cost = 0;           ///< of all its segments, see cost_of()
    std::uint64_t segment_bytes = 0;  ///< the bound of the last one
    bool open = false;                ///< the last one takes more records
    std::uint64_t written = 0;        ///< of the last one
    Bytes out;                        ///< for the last one, not yet written
    std::set<std::uint64_t> told;     ///< links whose certificates the last one has
  };
  using Peers = std::map<std::string, Peer, std::less<>>;

  void run();
  void write(ProofBatch& batch);
  bool find_room(Peers::iterator peer, const ProofBatch& batch, Bytes& beginning);
  void open_segment(Peer& peer);
  void add_records(Peer& peer, const Bytes& beginning, const ProofBatch& batch);
  [[nodiscard]] static Bytes beginning_of(const Peer& peer, const ProofBatch& batch);
  bool make_room(Peers::iterator peer, std::uint64_t bytes);
  void remove_oldest(Peers::iterator peer);
  void remove_last(Peers::iterator peer);
  void resize_last(Peer& peer, std::uint64_t size);
  [[nodiscard]] std::uint64_t cost_of(const Segment& segment) const;
  void flush(Peers::iterator peer);
  void flush_all();
  std::string append(Peers::const_iterator peer);
  void find_segments();
  void mend_last(Peers::iterator peer);
  void set_problem(std::string problem);
  [[nodiscard]] std::string path_of(const std::string& peer, std::uint64_t number) const;

  const std::string dir_;
  const std::uint64_t max_bytes_;
  const std::uint64_t segment_bytes_;

  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<ProofBatch> queue_;  ///< this and the next five are under the mutex; all below belongs to the thread
  std::size_t queued_ = 0;        ///< bytes
  std::map<std::string, std::size_t, std::less<>> queued_of_;
  std::uint64_t dropped_ = 0;
  std::string problem_;
  bool ending_ = false;

  Peers peers_;
  std::uint64_t cost_ = 0;  ///< of all segments
  std::uint64_t next_number_ = 1;
  std::size_t unwritten_ = 0;
  std::thread thread_;
};

}  // namespace trb::router
