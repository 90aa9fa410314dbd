#include "mpi/map_exchange.h"

#include <utility>

#include "mpi/array_messages.h"
#include "mpi/tile_messages.h"

namespace saw_ndt::internal {
namespace {

enum Tag : int {
  kAskForChunk = 1,  // to rank 0: how many scans the rank has done with since it asked before
  kChunk,            // from rank 0: number of the drive and those of its scans; nothing where there are no more
  kTiles,            // a message of tile_messages.h
  kEnd,              // the rank sends no more tiles: as kAskForChunk
};

}  // namespace

MapExchange::MapExchange(const boost::mpi::communicator& ranks, ScanDealer* dealer, WeightedMapBuilder& owned,
                         const std::function<void()>& scan_done)
    : ranks_(ranks), dealer_(dealer), owned_(owned), scan_done_(scan_done) {}

void MapExchange::run() {
  try {
    while (!isDone()) {
      rethrowFailure();
      askForChunks();
      const bool has_received = receiveAll();
      const bool has_sent = sendGiven();
      forgetSent();
      if (has_received || has_sent) continue;
      // Large messages leave in pieces, which MPI moves on when it is called.
      const std::chrono::microseconds patience = sent_.empty() ? kPatience : kPatience / 20;
      std::unique_lock<std::mutex> lock(mutex_);
      changed_.wait_for(lock, patience);
    }
  } catch (...) {
    const std::lock_guard<std::mutex> lock(mutex_);
    has_failed_ = true;
    changed_.notify_all();
    throw;
  }
}

bool MapExchange::isDone() const { return has_told_end_ && sent_.empty() && ranks_ended_ == ranks_.size() - 1; }

void MapExchange::rethrowFailure() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (failure_) std::rethrow_exception(failure_);
}

bool MapExchange::receiveAll() {
  bool any = false;
  while (const auto probed = ranks_.iprobe(boost::mpi::any_source, boost::mpi::any_tag)) {
    receive(*probed);
    any = true;
  }
  return any;
}

void MapExchange::receive(const boost::mpi::status& probed) {
  switch (probed.tag()) {
    case kAskForChunk:
      countScans(receiveArray<int>(ranks_, probed).front());
      dealTo(probed.source());
      break;
    case kChunk:
      takeChunk(receiveArray<int>(ranks_, probed));
      break;
    case kTiles:
      addMessage(receiveArray<char>(ranks_, probed), owned_);
      break;
    default:
      countScans(receiveArray<int>(ranks_, probed).front());
      ++ranks_ended_;
  }
}

// One chunk waits behind the one that is worked on, so that nobody waits for an answer.
void MapExchange::askForChunks() {
  if (dealer_ != nullptr) countScans(scans_done_.exchange(0));
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (has_asked_ || chunks_ended_ || !chunks_.empty()) return;
  }
  if (dealer_ != nullptr) {
    takeChunk(nextChunkMessage());
  } else {
    has_asked_ = true;
    sendArray(ranks_, 0, kAskForChunk, std::vector<int>{scans_done_.exchange(0)});
  }
}

void MapExchange::dealTo(int rank) { sendArray(ranks_, rank, kChunk, nextChunkMessage()); }

std::vector<int> MapExchange::nextChunkMessage() {
  std::vector<int> message;
  if (const std::optional<ScanChunk> chunk = dealer_->next()) {
    message.push_back(chunk->drive);
    message.insert(message.end(), chunk->scans.begin(), chunk->scans.end());
  }
  return message;
}

void MapExchange::takeChunk(const std::vector<int>& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  has_asked_ = false;
  if (message.empty()) {
    chunks_ended_ = true;
  } else {
    chunks_.push_back({message.front(), {message.begin() + 1, message.end()}});
  }
  changed_.notify_all();
}

bool MapExchange::sendGiven() {
  if (!sent_.empty() || has_told_end_) return false;
  std::optional<WeightedMapBuilder> given;
  bool ended = false;
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    given.swap(given_);
    ended = given_ended_;
    changed_.notify_all();
  }
  if (given) {
    std::vector<std::vector<std::vector<char>>> messages = messagesByOwner(*given, ranks_.size());
    given.reset();
    for (int owner = 0; owner < ranks_.size(); ++owner) {
      for (std::vector<char>& message : messages[static_cast<std::size_t>(owner)]) {
        if (owner == ranks_.rank()) {
          addMessage(message, owned_);
          continue;
        }
        bytes_sent_ += message.size();
        Sent& sent = sent_.emplace_back(Sent{std::move(message), {}});
        sent.request = ranks_.isend(owner, kTiles, sent.bytes.data(), static_cast<int>(sent.bytes.size()));
      }
    }
    return true;
  }
  if (!ended) return false;
  const std::vector<int> scans_done{scans_done_.exchange(0)};
  countScans(scans_done.front());
  for (int rank = 0; rank < ranks_.size(); ++rank) {
    if (rank != ranks_.rank()) sendArray(ranks_, rank, kEnd, scans_done);
  }
  has_told_end_ = true;
  return true;
}

void MapExchange::forgetSent() {
  sent_.remove_if([](Sent& sent) { return sent.request.test().has_value(); });
}

void MapExchange::countScans(int count) {
  if (!scan_done_) return;
  for (int i = 0; i < count; ++i) scan_done_();
}

std::optional<ScanChunk> MapExchange::nextChunk() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return !chunks_.empty() || chunks_ended_ || has_failed_; });
  if (chunks_.empty() || has_failed_) return std::nullopt;
  ScanChunk chunk = std::move(chunks_.front());
  chunks_.pop_front();
  changed_.notify_all();
  return chunk;
}

void MapExchange::give(WeightedMapBuilder&& collected) {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [&] { return !given_ || has_failed_; });
  given_ = std::move(collected);
  changed_.notify_all();
}

void MapExchange::end(std::exception_ptr failure) {
  const std::lock_guard<std::mutex> lock(mutex_);
  given_ended_ = true;
  failure_ = std::move(failure);
  changed_.notify_all();
}

}  // namespace saw_ndt::internal
