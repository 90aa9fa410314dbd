#pragma once

#include <cstddef>
#include <memory>
#include <vector>

namespace saw_ndt::internal {

struct BatchScratch;
struct BatchTotals;
struct LikelihoodSums;

/// Scratch memory of VectorizedNdtObjective and of likelihoods, which calls reuse so that none allocates. One for each
/// thread that calls them; what they hold is not copied.
struct BatchWorkspace {
  BatchWorkspace();
  ~BatchWorkspace();
  BatchWorkspace(const BatchWorkspace& other);
  BatchWorkspace& operator=(const BatchWorkspace& other);

  /// Makes room for so many threads.
  void prepare(int threads);

  std::vector<std::unique_ptr<BatchScratch>> scratch_of_worker;
  std::vector<BatchTotals> batch_totals;
  std::vector<LikelihoodSums> batch_likelihoods;
};

}  // namespace saw_ndt::internal
