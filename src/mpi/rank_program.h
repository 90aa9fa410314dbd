#pragma once

#include <boost/mpi/communicator.hpp>
#include <functional>
#include <string>

namespace saw_ndt::internal {

/// How a program of several ranks begins: rank 0 finds out whether the command line and what it names are right, and
/// tells the others, which wait meanwhile without using a core.
/// @param prepare  called on rank 0 with go(), which it calls once there is work for all ranks, and then does its part
/// of
///                 it; returns the exit code
/// @param work     called on the others when go() has been called
/// @return the exit code: on the others 0, also where there was no work
int runRanks(const boost::mpi::communicator& ranks, const std::function<int(const std::function<void()>& go)>& prepare,
             const std::function<void()>& work);

/// Does the work that ranks share. Where this one fails, the whole job is ended: "program: rank 2 (host): reason" is
/// told on stderr, and MPI ends all ranks with exit code 1.
void endJobOnFailure(const boost::mpi::communicator& ranks, const std::string& program,
                     const std::function<void()>& work);

/// How many ranks run on this machine. To be called by all of them.
int ranksOnThisMachine(const boost::mpi::communicator& ranks);

}  // namespace saw_ndt::internal
