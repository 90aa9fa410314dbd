#pragma once

#include <atomic>
#include <boost/mpi/communicator.hpp>
#include <boost/mpi/request.hpp>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <list>
#include <mutex>
#include <optional>
#include <vector>

#include "mpi/scan_dealer.h"
#include "saw_ndt/map/weighted_map_builder.h"

namespace saw_ndt::internal {

/// What the ranks tell each other while a map is built: which scans to work on, and the sums of what was seen in them,
/// which go to the ranks that own their tiles. One thread of a rank works on scans, another one, the only one that
/// calls MPI, runs this, so that no rank waits for the scan that another one is busy with.
class MapExchange {
 public:
  /// @param dealer     of all scans, on rank 0; null on the others
  /// @param owned      to which the sums of the rank's own tiles are added
  /// @param scan_done  called on rank 0 for every scan that some rank has added; may be empty
  MapExchange(const boost::mpi::communicator& ranks, ScanDealer* dealer, WeightedMapBuilder& owned,
              const std::function<void()>& scan_done);

  /// Sends and receives until every rank has ended and all sums are where they belong.
  /// @throws whatever the rank's own thread threw
  void run();

  // For the thread that works on scans.

  /// Waits for the next scans; nothing where there are no more, or where run() has failed.
  std::optional<ScanChunk> nextChunk();
  /// One more scan has been added or left out. May be called by any thread.
  void countScan() { ++scans_done_; }
  /// Hands over what has been collected, once what was handed over before is on its way: no more than that is kept.
  void give(WeightedMapBuilder&& collected);
  /// Nothing more will be given. A failure comes out of run().
  void end(std::exception_ptr failure = nullptr);

  /// How many bytes of sums this rank has sent to others.
  std::uint64_t bytesSent() const { return bytes_sent_; }

 private:
  void rethrowFailure();
  bool receiveAll();
  void receive(const boost::mpi::status& probed);
  void askForChunks();
  void dealTo(int rank);
  std::vector<int> nextChunkMessage();
  void takeChunk(const std::vector<int>& message);
  bool sendGiven();
  void forgetSent();
  void countScans(int count);
  bool isDone() const;

  boost::mpi::communicator ranks_;
  ScanDealer* dealer_;
  WeightedMapBuilder& owned_;
  const std::function<void()>& scan_done_;

  struct Sent {
    std::vector<char> bytes;
    boost::mpi::request request;
  };
  std::list<Sent> sent_;  // what has not left yet
  std::uint64_t bytes_sent_ = 0;
  bool has_asked_ = false;
  bool has_told_end_ = false;
  int ranks_ended_ = 0;

  std::atomic<int> scans_done_{0};
  mutable std::mutex mutex_;  // of what follows
  std::condition_variable changed_;
  std::deque<ScanChunk> chunks_;
  bool chunks_ended_ = false;
  std::optional<WeightedMapBuilder> given_;
  bool given_ended_ = false;
  std::exception_ptr failure_;  // of the rank's own thread
  bool has_failed_ = false;     // run()
};

}  // namespace saw_ndt::internal
