#include "picture_file.h"

#include <filesystem>

#include "app_options.h"
#include "common/atomic_output.h"

namespace saw_ndt {

void requireDrawable(const std::string& file) {
  if (file.empty()) return;
  if (std::filesystem::path(file).extension() != ".png") {
    throw UsageError("option -picture: " + file + " must end in .png");
  }
  if (!gnuplotFound()) {
    throw UsageError("option -picture: the program gnuplot is not installed (Debian: apt install gnuplot-nox)");
  }
  // This leaves nothing behind.
  const internal::AtomicOutput probe(file);
}

}  // namespace saw_ndt
