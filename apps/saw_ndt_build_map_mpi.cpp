#include <algorithm>
#include <boost/mpi/collectives.hpp>
#include <boost/mpi/environment.hpp>
#include <iostream>

#include "app_options.h"
#include "build_map_arguments.h"
#include "common/executor.h"
#include "common/program_signals.h"
#include "mpi/map_of_ranks.h"
#include "mpi/rank_map_file.h"
#include "mpi/rank_program.h"
#include "progress_bar.h"

namespace {

namespace mpi = boost::mpi;
using saw_ndt::internal::DrivePlan;
using saw_ndt::internal::MapOfRanks;

constexpr char kDescription[] =
    "Builds an NDT map as saw_ndt_build_map does, byte for byte, with several processes on one or many machines: "
    "`mpirun -n 4 saw_ndt_build_map_mpi SEQUENCE... MAP`. The first process, rank 0, learns how scans are to be "
    "segmented and deals them out; every process reads and segments those that it is given, keeps a share of the map's "
    "tiles and writes them into the map, so that all of them must see the recordings and the folder of the map. Where "
    "one fails, the job ends and there is no map. Unless -threads says otherwise, the processes on a machine share its "
    "cores.";

class RankProgram {
 public:
  RankProgram(int argc, char** argv, const mpi::communicator& ranks)
      : argc_(argc), argv_(argv), ranks_(ranks), app_("saw_ndt_build_map_mpi", kDescription), arguments_(app_) {}

  int run() {
    const int on_this_machine = saw_ndt::internal::ranksOnThisMachine(ranks_);
    cores_ = std::max(1, saw_ndt::internal::threadCount(0) / on_this_machine);
    return saw_ndt::internal::runRanks(
        ranks_,
        [&](const std::function<void()>& go) {
          return saw_ndt::runApp(argc_, argv_, app_, [&] {
            std::vector<DrivePlan> plans = arguments_.plan();
            go();
            shareWork(std::move(plans));
          });
        },
        [&] {
          app_.parse(argc_, argv_);
          shareWork({});
        });
  }

 private:
  void shareWork(std::vector<DrivePlan> of_rank_0) {
    saw_ndt::internal::endJobOnFailure(ranks_, app_.name(), [&] { build(std::move(of_rank_0)); });
  }

  void build(std::vector<DrivePlan> of_rank_0) {
    std::size_t scan_count = 0;
    for (const DrivePlan& plan : of_rank_0) scan_count += plan.scans.size();
    saw_ndt::ProgressBar progress(scan_count);
    const std::vector<DrivePlan> plans = saw_ndt::internal::toldPlans(ranks_, std::move(of_rank_0));
    std::vector<std::string> unused;
    saw_ndt::DriveMapOptions options = arguments_.options(unused, {});
    if (!app_.isGiven("threads")) options.threads = cores_;
    const MapOfRanks map = saw_ndt::internal::buildMapOfRanks(
        ranks_, plans, [&](int drive) -> const saw_ndt::Recording& { return arguments_.open(drive); }, options,
        std::filesystem::path(arguments_.mapFile()).parent_path() / ".", [&] { progress.step(); });
    for (const std::string& failure : map.left_out) std::cerr << app_.name() << ": " << failure << ": left out\n";
    const std::uint64_t own_voxels = saw_ndt::internal::writeMapOfRanks(ranks_, arguments_.mapFile(), map);
    if (ranks_.rank() != 0) return mpi::reduce(ranks_, own_voxels, std::plus<>(), 0);
    std::uint64_t voxels = 0;
    mpi::reduce(ranks_, own_voxels, voxels, std::plus<>(), 0);
    tell(map, voxels);
  }

  void tell(const MapOfRanks& map, std::uint64_t voxels) const {
    std::uint64_t least = map.work.front().scans, most = 0, bytes_sent = 0;
    for (const saw_ndt::internal::RankWork& work : map.work) {
      least = std::min(least, work.scans);
      most = std::max(most, work.scans);
      bytes_sent += work.bytes_sent;
    }
    std::cout << saw_ndt::mapText(arguments_.mapFile(), voxels, map.origin, map.left_out.size()) << '\n'
              << arguments_.motionText() << "ranks " << map.work.size() << ": " << least << " to " << most
              << " scans each, " << bytes_sent << " bytes of sums sent from rank to rank\n";
  }

  int argc_;
  char** argv_;
  const mpi::communicator& ranks_;
  saw_ndt::AppOptions app_;
  saw_ndt::BuildMapArguments arguments_;
  int cores_ = 1;
};

}  // namespace

int main(int argc, char** argv) {
  const mpi::environment environment(argc, argv, mpi::threading::funneled, false);
  saw_ndt::internal::handleProgramSignals();
  const mpi::communicator ranks;
  return RankProgram(argc, argv, ranks).run();
}
