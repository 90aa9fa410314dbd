#pragma once

#include <string>

#include "report/gnuplot.h"

namespace saw_ndt {

/// A part of a map seen from above, in its frame (m).
struct MapWindow {
  double x_min, x_max, y_min, y_max;
  bool contains(double x, double y) const { return x >= x_min && x <= x_max && y >= y_min && y <= y_max; }
};

/// The axes of a picture of a map seen from above: metres, of one scale along x and y, with room for a legend on the
/// right.
class MapAxes {
 public:
  /// @param window  to be shown, not empty; of a long and narrow one more is shown across
  explicit MapAxes(const MapWindow& window);

  const MapWindow& window() const { return window_; }
  /// Picture elements of GnuplotPicture::width_px a metre.
  double scale_px() const { return scale_px_; }

  /// Sets the picture's size, and begins its commands with those of the axes, the title and the legend's place.
  void begin(GnuplotPicture& picture, const std::string& title) const;

 private:
  MapWindow window_;
  double scale_px_;
};

}  // namespace saw_ndt
