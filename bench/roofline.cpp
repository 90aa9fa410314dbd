// Measures what the processor can do at most, and how near to that an evaluation of score, gradient and Hessian comes.

#include <omp.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <iomanip>
#include <iostream>
#include <random>
#include <thread>

#include "app_options.h"
#include "benchmark_program.h"
#include "benchmark_scans.h"
#include "evaluation/statistics.h"
#include "registration/ndt_evaluation.h"
#include "registration_case.h"
#include "roofline_kernels.h"

namespace {

// Floating-point operations of one evaluation, a multiply-add counted as two.
// A pair: offset q 3, C^-1 q 15, exponent and its exponential 15, force 6, curvature 12, radial curvature 12.
constexpr double kOperationsAPair = 63.0;
// W_ij of a weighted pair.
constexpr double kOperationsAWeight = 6.0;
// A point: moved 18, moment 18, the two curvatures turned into 6 x 6 matrices and added 132.
constexpr double kOperationsAPoint = 168.0;
// A pair reads the number of its voxel and the cache line of its cell; a point x, y, z and its label.
constexpr double kBytesAPair = 4.0 + 64.0;
constexpr double kBytesAPoint = 13.0;

constexpr std::size_t kGathered = 4096;
constexpr double kMinSeconds = 1e-3;

// Of every measurement.
int repetitions = 50;

double secondsBy(clockid_t clock) {
  timespec time;
  clock_gettime(clock, &time);
  return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

// Calls work(thread) in so many threads at once.
void inThreads(int threads, const std::function<void(int thread)>& work) {
  std::vector<std::thread> others;
  for (int thread = 1; thread < threads; ++thread) others.emplace_back(work, thread);
  work(0);
  for (std::thread& other : others) other.join();
}

// Seconds that one call takes a thread where each of `threads` makes it at once, `thread` being 0, 1, ...; the median
// of the repetitions. Counted is a thread's own time: other programs may hold up one of them.
double secondsACall(int threads, const std::function<float(int thread)>& call) {
  static std::atomic<float> sink{0.0F};
  const auto secondsOfCalls = [&](int calls, int thread) {
    float sum = 0.0F;
    const double start = secondsBy(CLOCK_THREAD_CPUTIME_ID);
    for (int i = 0; i < calls; ++i) sum += call(thread);
    const double seconds = secondsBy(CLOCK_THREAD_CPUTIME_ID) - start;
    sink = sum;
    return seconds;
  };
  int calls = 1;
  while (secondsOfCalls(calls, 0) < kMinSeconds && calls < (1 << 24)) calls *= 2;
  std::vector<double> seconds;
  for (int i = 0; i < repetitions; ++i) {
    std::vector<double> of_thread(static_cast<std::size_t>(threads));
    inThreads(threads,
              [&](int thread) { of_thread[static_cast<std::size_t>(thread)] = secondsOfCalls(calls, thread); });
    seconds.push_back(saw_ndt::internal::mean(of_thread) / calls);
  }
  return saw_ndt::internal::median(seconds);
}

// Figures of the processor, in 1e9 a second over all threads.
struct Processor {
  double operations = 0.0;
  double l1_bytes = 0.0, l2_bytes = 0.0, l3_bytes = 0.0, memory_bytes = 0.0;
  double l1_gathered = 0.0, l2_gathered = 0.0, broadcast = 0.0;
};

std::size_t cacheSize(int name, std::size_t usual) {
  const long stated = sysconf(name);
  return stated > 0 ? static_cast<std::size_t>(stated) : usual;
}

double readBytes(int threads, std::size_t bytes_a_thread) {
  const std::size_t count = bytes_a_thread / sizeof(float) / 128 * 128;
  // Filled by the thread that reads it.
  std::vector<std::vector<float>> values(static_cast<std::size_t>(threads));
  inThreads(threads, [&](int thread) { values[static_cast<std::size_t>(thread)].assign(count, 1.0F); });
  const double seconds = secondsACall(
      threads, [&](int t) { return saw_ndt::readValues(values[static_cast<std::size_t>(t)].data(), count); });
  return 1e-9 * static_cast<double>(threads) * static_cast<double>(count * sizeof(float)) / seconds;
}

double gathered(int threads, std::size_t table_bytes) {
  const std::vector<float> table(table_bytes / sizeof(float), 1.0F);
  std::mt19937 random(1);
  std::uniform_int_distribution<std::int32_t> anywhere(0, static_cast<std::int32_t>(table.size() - 1));
  std::vector<std::int32_t> indices(kGathered);
  for (std::int32_t& index : indices) index = anywhere(random);
  const double seconds =
      secondsACall(threads, [&](int) { return saw_ndt::gatherValues(table.data(), indices.data(), kGathered); });
  return 1e-9 * threads * static_cast<double>(kGathered) / seconds;
}

Processor measureProcessor(int threads) {
  const std::size_t l1 = cacheSize(_SC_LEVEL1_DCACHE_SIZE, 32 << 10), l2 = cacheSize(_SC_LEVEL2_CACHE_SIZE, 1 << 20),
                    l3 = cacheSize(_SC_LEVEL3_CACHE_SIZE, 16 << 20);
  Processor processor;
  double operations = 0.0;
  saw_ndt::multiplyAdd(1000, operations);
  processor.operations = 1e-9 * threads * operations / secondsACall(threads, [](int) {
                           double same = 0.0;
                           return saw_ndt::multiplyAdd(1000, same);
                         });
  processor.l1_bytes = readBytes(threads, l1 / 2);
  processor.l2_bytes = readBytes(threads, l2 / 2);
  processor.l3_bytes = readBytes(threads, std::max(2 * l2, std::min<std::size_t>(l3 / 4, 16 << 20)));
  processor.memory_bytes = readBytes(threads, 2 * l3 / static_cast<std::size_t>(threads));
  processor.l1_gathered = gathered(threads, l1 / 4);
  processor.l2_gathered = gathered(threads, l2 / 2);
  const std::vector<float> values(kGathered, 1.0F);
  processor.broadcast = 1e-9 * threads * static_cast<double>(kGathered) /
                        secondsACall(threads, [&](int) { return saw_ndt::broadcastValues(values.data(), kGathered); });
  return processor;
}

// One evaluation: seconds of the fastest repetition (one thread: its own time), and what it is made of.
struct Evaluation {
  double seconds = 1e9;
  double pairs = 0.0;
  double points = 0.0;
};

Evaluation measureEvaluation(const saw_ndt::RegistrationCase& scan, int threads) {
  saw_ndt::AlignmentOptions options = scan.options;
  options.threads = threads;
  saw_ndt::internal::NdtEvaluation source;
  source.begin(scan.target, scan.source, options);
  const saw_ndt::internal::Evaluation repeated = source.onMatchingLevels(saw_ndt::benchmarkPose());
  Evaluation evaluation;
  evaluation.points = static_cast<double>(scan.source.size());
  const clockid_t clock = threads > 1 ? CLOCK_MONOTONIC : CLOCK_THREAD_CPUTIME_ID;
  for (int i = 0; i < repetitions; ++i) {
    const double start = secondsBy(clock);
    const auto derivatives = repeated(saw_ndt::benchmarkPose());
    evaluation.seconds = std::min(evaluation.seconds, secondsBy(clock) - start);
    evaluation.pairs = static_cast<double>(derivatives.pair_count);
  }
  return evaluation;
}

struct Configuration {
  saw_ndt::internal::InstructionSet set;
  int threads;
  Processor processor;
};

std::ostream& startRow(const Configuration& c) {
  return std::cout << "| " << saw_ndt::internal::toString(c.set) << " | " << c.threads << " | ";
}

void printProcessor(const std::vector<Configuration>& configurations) {
  std::cout << "| instructions | threads | GFLOP/s | L1 / L2 / L3 / memory, GB/s | gathered from L1 / L2, 1e9/s | "
               "broadcast, 1e9/s |\n|---|---|---|---|---|---|\n";
  for (const Configuration& c : configurations) {
    const Processor& p = c.processor;
    startRow(c) << std::setprecision(1) << p.operations << " | " << p.l1_bytes << " / " << p.l2_bytes << " / "
                << p.l3_bytes << " / " << p.memory_bytes << " | " << std::setprecision(2) << p.l1_gathered << " / "
                << p.l2_gathered << " | " << p.broadcast << " |\n";
  }
}

void printEvaluations(const std::vector<Configuration>& configurations) {
  std::cout
      << "| instructions | threads | evaluation | points / pairs | FLOP a pair | bytes a pair | "
         "arithmetic bound, ns a pair | L1 / L2 / L3 / memory bound, ns a pair | measured, ns a pair | "
         "share of the arithmetic bound | share of the L2 bound |\n|---|---|---|---|---|---|---|---|---|---|---|\n";
  for (const Configuration& c : configurations) {
    const saw_ndt::InstructionSetLimit limit(c.set);
    for (const std::string name : {"classical", "weighted"}) {
      const saw_ndt::RegistrationCase& scan = saw_ndt::registrationCase(name);
      const Evaluation e = measureEvaluation(scan, c.threads);
      const double operations = kOperationsAPair + (scan.options.use_weights ? kOperationsAWeight : 0.0) +
                                kOperationsAPoint * e.points / e.pairs;
      const double bytes = kBytesAPair + kBytesAPoint * e.points / e.pairs;
      const double measured_ns = 1e9 * e.seconds / e.pairs;
      const double arithmetic_ns = operations / c.processor.operations;
      const double l2_ns = bytes / c.processor.l2_bytes;
      startRow(c) << name << " | " << std::setprecision(0) << e.points << " / " << e.pairs << " | " << operations
                  << " | " << bytes << " | " << std::setprecision(2) << arithmetic_ns << " | "
                  << bytes / c.processor.l1_bytes << " / " << l2_ns << " / " << bytes / c.processor.l3_bytes << " / "
                  << bytes / c.processor.memory_bytes << " | " << measured_ns << " | " << std::setprecision(0)
                  << 100.0 * arithmetic_ns / measured_ns << " % | " << 100.0 * l2_ns / measured_ns << " % |\n";
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  saw_ndt::AppOptions app(
      "roofline",
      "Measures how many single-precision operations, bytes, gathered and broadcast values the processor does a second "
      "with each instruction set, by one thread and by two; and an evaluation of score, gradient and Hessian of the "
      "benchmarks' scan beside the time that its operations and bytes take at least. The environment variable "
      "SAW_NDT_KITTI names a KITTI folder for the scan.");
  app.addOption("repetitions", &repetitions, "N", "of every measurement");
  return saw_ndt::runApp(argc, argv, app, [&] {
    if (repetitions < 1) throw saw_ndt::UsageError("option -repetitions: must be 1 or more");
    std::vector<Configuration> configurations;
    for (const saw_ndt::internal::InstructionSet set : saw_ndt::availableInstructionSets()) {
      for (const int threads : saw_ndt::benchmarkThreadCounts()) {
        const saw_ndt::InstructionSetLimit limit(set);
        configurations.push_back({set, threads, measureProcessor(threads)});
      }
    }
    std::cout << std::fixed;
    printProcessor(configurations);
    std::cout << "\nAn evaluation of " << saw_ndt::benchmarkSequenceDescription() << ", scan "
              << saw_ndt::benchmarkScanNumber() << ":\n\n";
    printEvaluations(configurations);
  });
}
