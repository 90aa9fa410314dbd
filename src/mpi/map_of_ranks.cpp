#include "mpi/map_of_ranks.h"

#include <algorithm>
#include <boost/mpi/collectives.hpp>
#include <boost/serialization/string.hpp>
#include <boost/serialization/vector.hpp>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "map/map_metadata.h"
#include "mpi/map_exchange.h"
#include "mpi/scan_dealer.h"
#include "saw_ndt/common/error.h"
#include "saw_ndt/version.h"

namespace saw_ndt::internal {
namespace {

// Entries that a rank collects, some 30 MB, before it sends them to their owners: what a rank needs besides its tiles.
constexpr std::size_t kMostCollected = std::size_t{1} << 18U;

/// The thread of a rank that adds scans to a builder of its own, chunk after chunk.
class ScanWorker {
 public:
  ScanWorker(MapExchange& exchange, const std::vector<DrivePlan>& plans, const DriveOpener& open,
             const DriveMapOptions& common)
      : exchange_(exchange), plans_(plans), open_(open), common_(common), collected_(newBuilder()) {
    if (common_.scan_left_out) {
      common_.scan_left_out = [this](const std::string& failure) {
        left_out_.push_back(failure);
        exchange_.countScan();
      };
    }
    thread_ = std::thread([this] { run(); });
  }
  ~ScanWorker() { join(); }
  ScanWorker(const ScanWorker&) = delete;
  ScanWorker& operator=(const ScanWorker&) = delete;

  void join() {
    if (thread_.joinable()) thread_.join();
  }
  // Once it has joined.
  std::uint64_t scanCount() const { return scan_count_; }
  const std::vector<std::string>& leftOut() const { return left_out_; }

 private:
  WeightedMapBuilder newBuilder() const {
    return WeightedMapBuilder(common_.resolution_m, plans_.front().segmentation);
  }

  void run() {
    try {
      while (const std::optional<ScanChunk> chunk = exchange_.nextChunk()) {
        add(*chunk);
        if (collected_.entryCount() >= kMostCollected) give();
      }
      give();
      exchange_.end();
    } catch (...) {
      exchange_.end(std::current_exception());
    }
  }

  void add(const ScanChunk& chunk) {
    if (drive_ != chunk.drive) {
      recording_ = &open_(chunk.drive);
      options_ = optionsFor(plans_.at(static_cast<std::size_t>(chunk.drive)), *recording_, common_);
      drive_ = chunk.drive;
    }
    addScans(*recording_->scans(chunk.scans), options_, collected_, [this] { exchange_.countScan(); });
  }

  void give() {
    scan_count_ += collected_.origin().scan_count;
    exchange_.give(std::exchange(collected_, newBuilder()));
  }

  MapExchange& exchange_;
  const std::vector<DrivePlan>& plans_;
  const DriveOpener& open_;
  DriveMapOptions common_;
  WeightedMapBuilder collected_;
  const Recording* recording_ = nullptr;
  DriveMapOptions options_;  // of its scans
  int drive_ = -1;
  std::uint64_t scan_count_ = 0;
  std::vector<std::string> left_out_;
  std::thread thread_;
};

}  // namespace

std::vector<DrivePlan> toldPlans(const boost::mpi::communicator& ranks, std::vector<DrivePlan> plans) {
  std::vector<std::string> segmentations;
  std::vector<int> motion_compensations;
  for (const DrivePlan& plan : plans) {
    MapOrigin origin;
    origin.segmentation = plan.segmentation;
    origin.software_version = SAW_NDT_VERSION;
    segmentations.push_back(metadataText(origin));
    motion_compensations.push_back(static_cast<int>(plan.motion_compensation));
  }
  boost::mpi::broadcast(ranks, segmentations, 0);
  boost::mpi::broadcast(ranks, motion_compensations, 0);
  if (ranks.rank() == 0) return plans;
  plans.resize(segmentations.size());
  for (std::size_t i = 0; i < plans.size(); ++i) {
    MapOrigin origin;
    const std::optional<MetadataFault> fault = readMetadata(segmentations[i], origin);
    if (fault || origin.software_version != SAW_NDT_VERSION) {
      throw Error("this program is version " SAW_NDT_VERSION ", and that of rank 0 is another one");
    }
    plans[i].segmentation = origin.segmentation;
    plans[i].motion_compensation = static_cast<MotionCompensation>(motion_compensations.at(i));
  }
  return plans;
}

MapOfRanks buildMapOfRanks(const boost::mpi::communicator& ranks, const std::vector<DrivePlan>& plans,
                           const DriveOpener& open, const DriveMapOptions& common,
                           const std::filesystem::path& spill_folder, const std::function<void()>& scan_done) {
  MapOfRanks map{WeightedMapBuilder(common.resolution_m, plans.front().segmentation), {}, {}, {}};
  map.owned.limitMemory(kMostEntriesInMemory, spill_folder);
  std::optional<ScanDealer> dealer;
  if (ranks.rank() == 0) {
    std::vector<std::vector<int>> scans;
    for (const DrivePlan& plan : plans) scans.push_back(plan.scans);
    dealer.emplace(std::move(scans), ranks.size());
  }
  MapExchange exchange(ranks, dealer ? &*dealer : nullptr, map.owned, scan_done);
  ScanWorker worker(exchange, plans, open, common);
  exchange.run();
  worker.join();

  std::vector<std::vector<std::string>> left_out;
  std::vector<std::uint64_t> scans, points, bytes_sent;
  boost::mpi::gather(ranks, worker.leftOut(), left_out, 0);
  boost::mpi::gather(ranks, worker.scanCount(), scans, 0);
  boost::mpi::gather(ranks, map.owned.origin().point_count, points, 0);
  boost::mpi::gather(ranks, exchange.bytesSent(), bytes_sent, 0);
  if (ranks.rank() != 0) return map;

  map.origin = WeightedMapBuilder(common.resolution_m, plans.front().segmentation).origin();
  map.origin.labelled = map.origin.segmentation.has_value();
  for (std::size_t rank = 0; rank < scans.size(); ++rank) {
    map.left_out.insert(map.left_out.end(), left_out[rank].begin(), left_out[rank].end());
    map.origin.scan_count += scans[rank];
    map.origin.point_count += points[rank];
    map.work.push_back({scans[rank], bytes_sent[rank]});
  }
  std::sort(map.left_out.begin(), map.left_out.end());
  requireAnyPoint(map.origin, map.left_out.empty() ? "" : map.left_out.back());
  return map;
}

}  // namespace saw_ndt::internal
