// Config files of the apps.
#include <vector>

#include "app_options.h"
#include "fuzzed_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static saw_ndt::FuzzedFile file("options.conf");
  file.tryReading(data, size, [](const std::filesystem::path& path) {
    saw_ndt::AppOptions options("app", "An app.");
    double length_m = 1.0;
    int count = 1;
    bool flag = false;
    std::string word = "one";
    std::vector<double> numbers;
    options.addOption("length", &length_m, "METRES", "a length");
    options.addOption("count", &count, "N", "a count");
    options.addOption("numbers", &numbers, "X,Y", "numbers");
    options.addFlag("flag", &flag, "a flag");
    options.addChoice("word", &word, {"one", "two"}, "a word");
    const char* const arguments[] = {"app", "-config", path.c_str()};
    try {
      options.parse(3, arguments);
    } catch (const saw_ndt::UsageError& error) {
      throw saw_ndt::Error(path.filename().string() + error.what());
    }
    saw_ndt::require(word == "one" || word == "two", "choices are one of the words");
  });
  return 0;
}
