#include "soak_record.h"

#include <malloc.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>

#include "evaluation/statistics.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {
namespace {

constexpr std::size_t kScansOfInterval = 1U << 16U;
constexpr double kBytesOfMb = 1024.0 * 1024.0;

std::size_t entriesOf(const char* folder) {
  return static_cast<std::size_t>(
      std::distance(std::filesystem::directory_iterator(folder), std::filesystem::directory_iterator()));
}

}  // namespace

double residentMemory_mb() {
  constexpr char kFile[] = "/proc/self/statm";
  std::size_t all_pages = 0, resident_pages = 0;
  if (!(std::ifstream(kFile) >> all_pages >> resident_pages)) throw Error(kFile, "", "cannot be read");
  return static_cast<double>(resident_pages) * static_cast<double>(sysconf(_SC_PAGESIZE)) / kBytesOfMb;
}

SoakRecord::SoakRecord() {
  for (std::vector<double>* values : {&total_ms_, &cpu_ms_, &resident_mb_}) values->reserve(kScansOfInterval);
}

void SoakRecord::add(double total_ms, double cpu_ms) {
  total_ms_.push_back(total_ms);
  cpu_ms_.push_back(cpu_ms);
  resident_mb_.push_back(residentMemory_mb());
}

SoakInterval SoakRecord::endInterval(SoakInterval counts) {
  counts.resident_mb = internal::median(resident_mb_);
  malloc_trim(0);
  counts.held_mb = residentMemory_mb();
  counts.median_ms = internal::median(total_ms_);
  counts.p99_ms = internal::percentile(total_ms_, 99.0);
  counts.median_cpu_ms = internal::median(cpu_ms_);
  counts.descriptors = entriesOf("/proc/self/fd") - 1;  // the one that lists them
  counts.threads = entriesOf("/proc/self/task");
  for (std::vector<double>* values : {&total_ms_, &cpu_ms_, &resident_mb_}) values->clear();
  return counts;
}

Slope slopeOf(const std::vector<double>& hours, const std::vector<double>& values) {
  const double mean_h = internal::mean(hours);
  Slope slope;
  slope.mean = internal::mean(values);
  double spread = 0.0, product = 0.0;
  for (std::size_t i = 0; i < hours.size(); ++i) {
    spread += (hours[i] - mean_h) * (hours[i] - mean_h);
    product += (hours[i] - mean_h) * (values[i] - slope.mean);
  }
  slope.per_hour = product / spread;
  double residual = 0.0;
  for (std::size_t i = 0; i < hours.size(); ++i) {
    const double off = values[i] - slope.mean - slope.per_hour * (hours[i] - mean_h);
    residual += off * off;
  }
  slope.sigma = std::sqrt(residual / static_cast<double>(hours.size() - 2) / spread);
  return slope;
}

}  // namespace saw_ndt
