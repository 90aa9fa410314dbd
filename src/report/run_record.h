#pragma once

#include <string>
#include <vector>

namespace saw_ndt {

/// What must be known of a measurement to repeat it and to judge its run times.
struct RunRecord {
  std::string command;    ///< as typed into a shell
  std::string date;       ///< UTC, such as 2026-01-31 12:00:00 UTC
  std::string cpu_model;  ///< "unknown" where the system does not tell
  int cores = 0;          ///< that the system offers
  int threads = 0;        ///< that were used
};

/// The record of a run that starts now.
/// @param arguments  the command line, the program first
RunRecord recordRun(const std::vector<std::string>& arguments, int threads);

}  // namespace saw_ndt
