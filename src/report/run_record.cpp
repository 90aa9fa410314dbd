#include "report/run_record.h"

#include <ctime>
#include <fstream>
#include <thread>

namespace saw_ndt {
namespace {

std::string cpuModel() {
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);) {
    if (line.rfind("model name", 0) != 0) continue;
    const std::size_t colon = line.find(':');
    const std::size_t value = colon == std::string::npos ? colon : line.find_first_not_of(" \t", colon + 1);
    if (value != std::string::npos) return line.substr(value);
  }
  return "unknown";
}

std::string quotedForShell(const std::string& argument) {
  constexpr char kPlain[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789_-+=.,:/@%";
  if (!argument.empty() && argument.find_first_not_of(kPlain) == std::string::npos) return argument;
  std::string result = "'";
  for (const char c : argument) result += c == '\'' ? std::string("'\\''") : std::string(1, c);
  return result + "'";
}

std::string dateNow() {
  const std::time_t now = std::time(nullptr);
  std::tm utc{};
  gmtime_r(&now, &utc);
  char text[32];
  return {text, std::strftime(text, sizeof text, "%Y-%m-%d %H:%M:%S UTC", &utc)};
}

}  // namespace

RunRecord recordRun(const std::vector<std::string>& arguments, int threads) {
  RunRecord record;
  for (const std::string& argument : arguments) {
    record.command += (record.command.empty() ? "" : " ") + quotedForShell(argument);
  }
  record.date = dateNow();
  record.cpu_model = cpuModel();
  record.cores = static_cast<int>(std::thread::hardware_concurrency());
  record.threads = threads;
  return record;
}

}  // namespace saw_ndt
