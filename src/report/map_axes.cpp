#include "report/map_axes.h"

#include <algorithm>
#include <sstream>

namespace saw_ndt {
namespace {

constexpr double kMaxWidth_px = 920.0, kMaxHeight_px = 900.0, kMinWidth_px = 330.0, kMinHeight_px = 330.0;
constexpr double kLeft_px = 100.0, kLegend_px = 215.0, kTop_px = 45.0, kBottom_px = 60.0;

/// Widens a range about its middle to a length at least.
void widen(double& low, double& high, double length) {
  const double middle = 0.5 * (low + high), half = 0.5 * std::max(high - low, length);
  low = middle - half;
  high = middle + half;
}

}  // namespace

MapAxes::MapAxes(const MapWindow& window)
    : window_(window),
      scale_px_(std::min(kMaxWidth_px / (window.x_max - window.x_min), kMaxHeight_px / (window.y_max - window.y_min))) {
  widen(window_.x_min, window_.x_max, kMinWidth_px / scale_px_);
  widen(window_.y_min, window_.y_max, kMinHeight_px / scale_px_);
}

void MapAxes::begin(GnuplotPicture& picture, const std::string& title) const {
  const double width_px = (window_.x_max - window_.x_min) * scale_px_;
  const double height_px = (window_.y_max - window_.y_min) * scale_px_;
  picture.width_px = static_cast<int>(kLeft_px + width_px + kLegend_px);
  picture.height_px = static_cast<int>(kTop_px + height_px + kBottom_px);
  const auto screen_x = [&](double px) { return px / picture.width_px; };
  const auto screen_y = [&](double px) { return px / picture.height_px; };
  std::ostringstream draw;
  draw.precision(12);
  draw << "set lmargin at screen " << screen_x(kLeft_px) << "\nset rmargin at screen " << screen_x(kLeft_px + width_px)
       << "\nset bmargin at screen " << screen_y(kBottom_px) << "\nset tmargin at screen "
       << screen_y(kBottom_px + height_px) << "\nset size ratio -1\nset xrange [" << window_.x_min << ':'
       << window_.x_max << "]\nset yrange [" << window_.y_min << ':' << window_.y_max
       << "]\nset tics out nomirror\nset format '%.10g'\nset border lc rgb '#555555'\nset xlabel 'x in the map (m)'\n"
          "set ylabel 'y in the map (m)'\nset title "
       << gnuplotQuoted(title) << "\nset key at screen " << screen_x(kLeft_px + width_px + 15.0) << ", screen "
       << screen_y(kBottom_px + height_px) << " left top Left reverse samplen 2 spacing 1.3 width -2\n";
  picture.commands = draw.str() + picture.commands;
}

}  // namespace saw_ndt
