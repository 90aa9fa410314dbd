#pragma once

#include <functional>
#include <string>

namespace saw_ndt {

/// What a piece of work took.
struct ProcessCost {
  double seconds = 0.0;
  double peak_mb = 0.0;  ///< of the process that did it
};

/// Runs something in a process of its own. @throws Error where it fails; the reason is on stderr then
ProcessCost costOf(const std::function<void()>& work);

/// Puts what is in memory of a file out of it. @throws Error where it cannot be opened
void leavePageCache(const std::string& path);

}  // namespace saw_ndt
