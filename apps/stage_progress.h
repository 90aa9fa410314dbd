#pragma once

#include <cstddef>
#include <memory>
#include <string>

#include "progress_bar.h"

namespace saw_ndt {

/// Work in several stages: a line on stderr as each begins, "app: 2 of 6: description", and below it a progress bar
/// where that is a terminal.
class StageProgress {
 public:
  /// @param name    of the app
  /// @param stages  how many there are
  StageProgress(std::string name, std::size_t stages);

  /// A stage of so many steps begins.
  void begin(const std::string& description, std::size_t steps);
  /// One step of it is done; may be called from several threads.
  void step();

 private:
  std::string name_;
  std::size_t stages_;
  std::size_t begun_ = 0;
  std::unique_ptr<ProgressBar> bar_;
};

}  // namespace saw_ndt
