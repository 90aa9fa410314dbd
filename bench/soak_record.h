#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace saw_ndt {

/// Resident memory of this process (MB), as the system tells it.
double residentMemory_mb();

/// What a process did in some time.
struct SoakInterval {
  double end_h = 0.0;  ///< since it began
  double seconds = 0.0;
  double resident_mb = 0.0;  ///< median
  double held_mb = 0.0;      ///< resident in the end, once all memory that is free has been given back to the system
  std::size_t descriptors = 0, threads = 0;
  std::size_t scans = 0, accepted = 0, rejected = 0, lost = 0;
  std::size_t wrong = 0;   ///< of those accepted, more than a metre off
  std::size_t helped = 0;  ///< times that the pose had to be told
  double median_ms = 0.0, p99_ms = 0.0;
  double median_cpu_ms = 0.0;  ///< of all threads of the process, which other programs disturb less
};

/// Numbers that are gathered from scan to scan. It needs no memory that grows from interval to interval.
class SoakRecord {
 public:
  SoakRecord();
  void add(double total_ms, double cpu_ms);
  /// What the interval told so far; begins the next one.
  SoakInterval endInterval(SoakInterval counts);

 private:
  std::vector<double> total_ms_, cpu_ms_, resident_mb_;
};

/// A straight line through values by time, by least squares.
struct Slope {
  double per_hour = 0.0;
  double sigma = 0.0;  ///< standard deviation of per_hour, from how far the values are from the line
  double mean = 0.0;   ///< of the values

  /// Whether it rises faster than `most`, and not by chance.
  bool exceeds(double most) const { return per_hour > most && per_hour > 2.0 * sigma; }
};

/// Of three or more values.
Slope slopeOf(const std::vector<double>& hours, const std::vector<double>& values);

}  // namespace saw_ndt
