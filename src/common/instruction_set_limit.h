#pragma once

namespace saw_ndt::internal {

/// Sees to it that the environment variable is obeyed before Highway first chooses; cheap from then on.
void obeyInstructionSetLimit();

}  // namespace saw_ndt::internal
