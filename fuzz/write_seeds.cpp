// write_seeds FOLDER: writes what the fuzzers begin with, a folder for each.
#include <cstdio>
#include <exception>
#include <fstream>
#include <random>

#include "seeds.h"

namespace saw_ndt {

namespace fs = std::filesystem;

fs::path SeedFolder::fileFor(const std::string& fuzzer, const std::string& name) const {
  fs::create_directories(path_ / fuzzer);
  return path_ / fuzzer / name;
}

void SeedFolder::add(const std::string& fuzzer, const std::string& name, const std::string& content) const {
  std::ofstream(fileFor(fuzzer, name), std::ios::binary) << content;
}

void writeAlgorithmSeeds(const SeedFolder& seeds) {
  std::mt19937 random(1);
  for (const char* fuzzer : {"alignment", "localizer", "map_building", "search", "segmentation", "source_filter"}) {
    for (int seed = 0; seed < 24; ++seed) {
      std::string bytes(std::size_t{32} << static_cast<unsigned>(seed % 6), '\0');
      for (char& byte : bytes) byte = static_cast<char>(random());
      seeds.add(fuzzer, "random" + std::to_string(seed), bytes);
    }
  }
}

}  // namespace saw_ndt

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("Usage: write_seeds FOLDER\n", stderr);
    return 2;
  }
  try {
    const saw_ndt::SeedFolder seeds(argv[1]);
    saw_ndt::writeFileSeeds(seeds);
    saw_ndt::writeMapSeeds(seeds);
    saw_ndt::writeRecordingSeeds(seeds);
    saw_ndt::writeAlgorithmSeeds(seeds);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "write_seeds: %s\n", error.what());
    return 1;
  }
  return 0;
}
