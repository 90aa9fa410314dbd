#pragma once

#include <filesystem>
#include <string>

namespace saw_ndt {

/// The folder with a folder of inputs for each fuzzer.
class SeedFolder {
 public:
  explicit SeedFolder(std::filesystem::path path) : path_(std::move(path)) {}

  /// Where an input of a fuzzer is to be written.
  std::filesystem::path fileFor(const std::string& fuzzer, const std::string& name) const;
  void add(const std::string& fuzzer, const std::string& name, const std::string& content) const;

 private:
  std::filesystem::path path_;
};

void writeFileSeeds(const SeedFolder& seeds);
void writeMapSeeds(const SeedFolder& seeds);
void writeRecordingSeeds(const SeedFolder& seeds);
void writeAlgorithmSeeds(const SeedFolder& seeds);

}  // namespace saw_ndt
