#pragma once

#include <string>

#include "app_options.h"

namespace saw_ndt {

/// The option -bin-fields of every app that reads .bin scans.
class BinFieldsArgument {
 public:
  void addTo(AppOptions& app) {
    app.addChoice("bin-fields", &text_, {"4", "5", "6"},
                  "floats a point of .bin files: x y z intensity, then ring or time or both (default: told from the "
                  "values)");
  }
  /// 0 where it is not given.
  int value() const { return text_.empty() ? 0 : std::stoi(text_); }

 private:
  std::string text_;
};

}  // namespace saw_ndt
