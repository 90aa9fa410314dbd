#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace saw_ndt {

/// Whether the program gnuplot is found.
bool gnuplotFound();

/// Picture elements of a PNG file for one of GnuplotPicture's: sharp on dense displays.
constexpr double kPngScale = 1.5;

/// A picture in gnuplot's words.
struct GnuplotPicture {
  std::string name;  ///< of its files, without an ending
  int width_px = 0;
  int height_px = 0;
  bool many_points = false;  ///< then there is no SVG, which would be too large
  std::string data;          ///< named data blocks
  std::string commands;      ///< what is to be drawn
  std::string caption;       ///< words for below the picture, not drawn
};

/// Draws the picture into `folder/name.png` and, unless it has many points, `folder/name.svg`.
/// @throws Error with gnuplot's message
void drawPicture(const GnuplotPicture& picture, const std::filesystem::path& folder);

/// Draws the picture into a PNG file, whole or not at all, whatever its name.
/// @param file  ends in .png
/// @throws Error with gnuplot's message, or where the file cannot be written
void drawPng(GnuplotPicture picture, const std::filesystem::path& file);

/// A text as gnuplot takes it: in the quotes within which nothing has a meaning, line breaks as spaces.
std::string gnuplotQuoted(const std::string& text);

/// A data block: its name, such as $points, and lines of the given columns, which are equally long.
std::string gnuplotData(const std::string& name, const std::vector<std::vector<double>>& columns);

}  // namespace saw_ndt
