#include "registration/batch_workspace.h"

#include "registration/batch_voxel_finder.h"

namespace saw_ndt::internal {

BatchWorkspace::BatchWorkspace() = default;
BatchWorkspace::~BatchWorkspace() = default;
BatchWorkspace::BatchWorkspace(const BatchWorkspace&) {}
BatchWorkspace& BatchWorkspace::operator=(const BatchWorkspace&) { return *this; }

void BatchWorkspace::prepare(int threads) {
  while (scratch_of_worker.size() < static_cast<std::size_t>(threads)) {
    scratch_of_worker.push_back(std::make_unique<BatchScratch>());
  }
}

}  // namespace saw_ndt::internal
