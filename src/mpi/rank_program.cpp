#include "mpi/rank_program.h"

#include <mpi.h>

#include <boost/mpi/environment.hpp>
#include <exception>
#include <iostream>
#include <new>

#include "mpi/array_messages.h"

namespace saw_ndt::internal {
namespace {

constexpr int kGoTag = 100;
constexpr int kGo = 1, kNothingToDo = 0;

void tellOthers(const boost::mpi::communicator& ranks, int what) {
  for (int rank = 1; rank < ranks.size(); ++rank) sendArray(ranks, rank, kGoTag, std::vector<int>{what});
}

}  // namespace

int runRanks(const boost::mpi::communicator& ranks, const std::function<int(const std::function<void()>& go)>& prepare,
             const std::function<void()>& work) {
  if (ranks.rank() != 0) {
    if (awaitArray<int>(ranks, 0, kGoTag).front() == kGo) work();
    return 0;
  }
  bool has_work = false;
  const int exit_code = prepare([&] {
    has_work = true;
    tellOthers(ranks, kGo);
  });
  if (!has_work) tellOthers(ranks, kNothingToDo);
  return exit_code;
}

void endJobOnFailure(const boost::mpi::communicator& ranks, const std::string& program,
                     const std::function<void()>& work) {
  std::string reason;
  try {
    work();
    return;
  } catch (const std::bad_alloc&) {
    reason = "out of memory";
  } catch (const std::exception& error) {
    reason = error.what();
  }
  std::cerr << program + ": rank " + std::to_string(ranks.rank()) + " (" + boost::mpi::environment::processor_name() +
                   "): " + reason + '\n'
            << std::flush;
  boost::mpi::environment::abort(1);
}

int ranksOnThisMachine(const boost::mpi::communicator& ranks) {
  MPI_Comm machine = MPI_COMM_NULL;
  MPI_Comm_split_type(ranks, MPI_COMM_TYPE_SHARED, 0, MPI_INFO_NULL, &machine);
  int count = 1;
  MPI_Comm_size(machine, &count);
  MPI_Comm_free(&machine);
  return count;
}

}  // namespace saw_ndt::internal
