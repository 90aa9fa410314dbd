#pragma once

#include <cstdint>
#include <filesystem>
#include <istream>
#include <string>
#include <vector>

#include "io/pcd_header.h"

namespace saw_ndt::internal {

/// Reads the points of an ASCII PCD file from behind its head, one point after the other in the form of a binary file.
/// Padding (fields named `_`) stays 0; blank lines are skipped.
class PcdAsciiRows {
 public:
  /// @param stream  stands behind the head, and outlives this object
  PcdAsciiRows(const std::filesystem::path& path, const PcdHeader& header, std::istream& stream);

  /// The next points, no more than the head announces. Throws Error that names the line of what is no number of its
  /// field's type, or of a point with other numbers of values, and where the file ends before.
  std::vector<unsigned char> read(std::uint64_t points);
  /// Throws Error that names the line of a point beyond the announced ones.
  void requireEnd();

 private:
  bool nextLine();
  [[noreturn]] void refuse(const std::string& reason) const;
  void store(unsigned char* to) const;

  std::filesystem::path path_;
  PcdHeader header_;
  std::istream& stream_;
  std::string line_;
  std::size_t line_number_;
  std::uint64_t points_read_ = 0;
  std::size_t values_ = 0;  // of a point
};

/// All the points that the head announces. Throws Error as above.
std::vector<unsigned char> readPcdAscii(const std::filesystem::path& path, const PcdHeader& header,
                                        std::istream& stream);

}  // namespace saw_ndt::internal
