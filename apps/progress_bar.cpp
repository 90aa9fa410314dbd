#include "progress_bar.h"

#include <unistd.h>

#include <boost/timer/progress_display.hpp>
#include <iostream>

namespace saw_ndt {

struct ProgressBar::Display {
  explicit Display(std::size_t total) : bar(total, std::cerr, "", "", "") {}
  boost::timer::progress_display bar;
};

ProgressBar::ProgressBar(std::size_t total) {
  if (total > 0 && isatty(STDERR_FILENO) == 1) display_ = std::make_unique<Display>(total);
}

ProgressBar::~ProgressBar() {
  // The display ends its line when it is full; after a failure the message shall have a line of its own.
  if (display_ != nullptr && display_->bar.count() < display_->bar.expected_count()) std::cerr << std::endl;
}

void ProgressBar::step() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (display_ != nullptr && display_->bar.count() < display_->bar.expected_count()) ++display_->bar;
}

}  // namespace saw_ndt
