#pragma once

#include <boost/mpi/communicator.hpp>
#include <chrono>
#include <string>
#include <thread>
#include <vector>

namespace saw_ndt::internal {

// Messages of an array of numbers or characters, whose length the receiver learns from MPI.

/// How long a rank that waits sleeps until it looks again. The waits of MPI itself keep a core busy, which others need.
constexpr std::chrono::milliseconds kPatience(1);

template <typename Element>
void sendArray(const boost::mpi::communicator& ranks, int destination, int tag, const std::vector<Element>& values) {
  ranks.send(destination, tag, values.data(), static_cast<int>(values.size()));
}

/// Receives the message that a probe has told of.
template <typename Element>
std::vector<Element> receiveArray(const boost::mpi::communicator& ranks, const boost::mpi::status& probed) {
  std::vector<Element> values(static_cast<std::size_t>(probed.template count<Element>().value_or(0)));
  ranks.recv(probed.source(), probed.tag(), values.data(), static_cast<int>(values.size()));
  return values;
}

/// Waits for a message and receives it.
template <typename Element>
std::vector<Element> awaitArray(const boost::mpi::communicator& ranks, int source, int tag) {
  while (true) {
    if (const auto status = ranks.iprobe(source, tag)) return receiveArray<Element>(ranks, *status);
    std::this_thread::sleep_for(kPatience);
  }
}

}  // namespace saw_ndt::internal
