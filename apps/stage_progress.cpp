#include "stage_progress.h"

#include <iostream>
#include <utility>

namespace saw_ndt {

StageProgress::StageProgress(std::string name, std::size_t stages) : name_(std::move(name)), stages_(stages) {}

void StageProgress::begin(const std::string& description, std::size_t steps) {
  bar_.reset();  // ends its line
  std::cerr << name_ << ": " << ++begun_ << " of " << stages_ << ": " << description << std::endl;
  bar_ = std::make_unique<ProgressBar>(steps);
}

void StageProgress::step() {
  if (bar_ != nullptr) bar_->step();
}

}  // namespace saw_ndt
