#pragma once

#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

namespace saw_ndt {

/// A field of a PCD file to write, as its head names it, and a value of each point (all `count` of them are the same).
struct TestField {
  std::string name;
  char type;
  int size;
  int count;
  std::vector<double> values;
};

inline std::string bytesOfNumber(double value, char type, int size) {
  const auto bytes = [](auto number) { return std::string(reinterpret_cast<const char*>(&number), sizeof(number)); };
  if (type == 'F') return size == 4 ? bytes(static_cast<float>(value)) : bytes(value);
  // Two's complement, little-endian: the low bytes are the same for every size.
  return bytes(static_cast<std::int64_t>(value)).substr(0, static_cast<std::size_t>(size));
}

/// The text of a PCD file, `data` being ascii or binary; unorganized where no shape is given.
inline std::string pcdText(const std::vector<TestField>& fields, const std::string& data,
                           const std::string& shape = "") {
  const std::size_t points = fields.front().values.size();
  std::ostringstream names, sizes, types, counts, body;
  body.precision(17);
  for (const TestField& field : fields) {
    names << ' ' << field.name;
    sizes << ' ' << field.size;
    types << ' ' << field.type;
    counts << ' ' << field.count;
  }
  for (std::size_t i = 0; i < points; ++i) {
    for (const TestField& field : fields) {
      for (int k = 0; k < field.count; ++k) {
        if (data == "ascii") {
          body << field.values[i] << ' ';
        } else {
          body << bytesOfNumber(field.values[i], field.type, field.size);
        }
      }
    }
    if (data == "ascii") body << '\n';
  }
  return "# .PCD v0.7\nVERSION 0.7\nFIELDS" + names.str() + "\nSIZE" + sizes.str() + "\nTYPE" + types.str() +
         "\nCOUNT" + counts.str() + "\n" +
         (shape.empty() ? "WIDTH " + std::to_string(points) + "\nHEIGHT 1\n" : shape) +
         "VIEWPOINT 1 2 3 0.5 0.5 0.5 0.5\nPOINTS " + std::to_string(points) + "\nDATA " + data + "\n" + body.str();
}

}  // namespace saw_ndt
