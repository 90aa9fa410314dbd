// Prints what Google Benchmark programs wrote as JSON as Markdown tables, PCL's figures beside ours.

#include <algorithm>
#include <fstream>
#include <iomanip>
#include <iostream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "app_options.h"
#include "common/instruction_set.h"
#include "saw_ndt/common/error.h"

namespace {

// What is no counter of ours among the members of a benchmark.
const std::set<std::string> kOwnMembers = {"name",
                                           "run_name",
                                           "run_type",
                                           "aggregate_name",
                                           "aggregate_unit",
                                           "family_index",
                                           "per_family_instance_index",
                                           "repetitions",
                                           "repetition_index",
                                           "threads",
                                           "iterations",
                                           "real_time",
                                           "cpu_time",
                                           "time_unit",
                                           "label"};
const std::string kTimePer = "time_per_";
const std::string kPcl = "pcl/";
const std::string kThreads = "threads:";

struct Measurement {
  double real_ms = 0.0;
  double cpu_ms = 0.0;
  std::map<std::string, double> counters;
};

// One line of a table: the same work by each instruction set and number of threads.
struct Row {
  std::string stage;
  std::map<saw_ndt::internal::InstructionSet, std::map<int, Measurement>> ours;
};

struct Program {
  std::string title;
  std::vector<Row> rows;                                    // in the order of the program
  std::vector<std::pair<std::string, Measurement>> of_pcl;  // stage without "pcl/", likewise
};

std::vector<std::string> partsOf(const std::string& name) {
  std::vector<std::string> parts;
  std::istringstream stream(name);
  for (std::string part; std::getline(stream, part, '/');) parts.push_back(part);
  return parts;
}

std::string joined(const std::vector<std::string>& parts) {
  std::string text;
  for (const std::string& part : parts) text += (text.empty() ? "" : "/") + part;
  return text;
}

Measurement measurementOf(const nlohmann::json& benchmark) {
  static const std::map<std::string, double> kMilliseconds = {{"ns", 1e-6}, {"us", 1e-3}, {"ms", 1.0}, {"s", 1e3}};
  const double unit_ms = kMilliseconds.at(benchmark.at("time_unit").get<std::string>());
  Measurement measurement;
  measurement.real_ms = unit_ms * benchmark.at("real_time").get<double>();
  measurement.cpu_ms = unit_ms * benchmark.at("cpu_time").get<double>();
  for (const auto& [name, value] : benchmark.items()) {
    if (value.is_number() && kOwnMembers.count(name) == 0) measurement.counters[name] = value.get<double>();
  }
  return measurement;
}

// Sorts a benchmark in by its name STAGE/INSTRUCTION_SET/threads:N or pcl/STAGE; what Google Benchmark adds to names
// ("real_time", "repeats:1") tells nothing here.
void add(Program& program, const nlohmann::json& benchmark) {
  std::vector<std::string> parts = partsOf(benchmark.at("run_name").get<std::string>());
  int threads = 1;
  for (auto part = parts.begin(); part != parts.end();) {
    const bool is_threads = part->rfind(kThreads, 0) == 0;
    if (is_threads) threads = std::stoi(part->substr(kThreads.size()));
    const bool added = is_threads || *part == "real_time" || *part == "process_time" || part->rfind("repeats:", 0) == 0;
    part = added ? parts.erase(part) : part + 1;
  }
  const Measurement measurement = measurementOf(benchmark);
  if (parts.front() + "/" == kPcl) {
    program.of_pcl.emplace_back(joined({parts.begin() + 1, parts.end()}), measurement);
    return;
  }
  const saw_ndt::internal::InstructionSet set = saw_ndt::internal::instructionSetNamed(parts.back());
  parts.pop_back();
  const std::string stage = joined(parts);
  auto row = std::find_if(program.rows.begin(), program.rows.end(), [&](const Row& r) { return r.stage == stage; });
  if (row == program.rows.end()) row = program.rows.insert(row, {stage, {}});
  row->ours[set][threads] = measurement;
}

// The content of a file, with null for NaN, which Google Benchmark writes though JSON has none: the variation of a
// counter that is always 0.
std::string textOf(const std::string& path) {
  std::ifstream stream(path);
  if (!stream) throw saw_ndt::Error(path, "", "cannot be read");
  std::string text;
  for (std::string line; std::getline(stream, line);) {
    const std::size_t value = line.find(": NaN");
    text += (value == std::string::npos ? line : line.replace(value, 5, ": null")) + "\n";
  }
  return text;
}

// The medians where the program repeated, otherwise the only runs.
Program read(const std::string& path) {
  const std::string text = textOf(path);
  Program program;
  try {
    const nlohmann::json file = nlohmann::json::parse(text);
    const nlohmann::json& context = file.at("context");
    program.title = context.at("executable").get<std::string>();
    program.title.erase(0, program.title.find_last_of('/') + 1);
    program.title += ": " + context.value("data", "");
    if (context.contains("points")) program.title += ", " + context.at("points").get<std::string>() + " points";
    // In the order of the program, whatever order they were run in.
    std::vector<nlohmann::json> benchmarks = file.at("benchmarks");
    std::stable_sort(benchmarks.begin(), benchmarks.end(), [](const nlohmann::json& first, const nlohmann::json& next) {
      return first.value("family_index", 0) < next.value("family_index", 0);
    });
    for (const nlohmann::json& benchmark : benchmarks) {
      if (benchmark.value("error_occurred", false)) {
        throw saw_ndt::Error(
            path, "", benchmark.at("name").get<std::string>() + " failed: " + benchmark.value("error_message", ""));
      }
      const bool repeated = benchmark.at("run_type") == "aggregate";
      if (repeated ? benchmark.at("aggregate_name") == "median" : benchmark.value("repetitions", 1) <= 1) {
        add(program, benchmark);
      }
    }
  } catch (const nlohmann::json::exception& error) {
    throw saw_ndt::Error(path, "", error.what());
  } catch (const std::logic_error& error) {
    throw saw_ndt::Error(path, "", std::string("a benchmark is named in another way: ") + error.what());
  }
  return program;
}

std::string threeDigits(double value) {
  std::ostringstream stream;
  const int digits = value >= 100.0 ? 0 : value >= 10.0 ? 1 : value >= 1.0 ? 2 : 3;
  stream << std::fixed << std::setprecision(digits) << value;
  return stream.str();
}

std::string countersOf(const Measurement& measurement) {
  std::string text;
  for (const auto& [name, value] : measurement.counters) {
    if (!text.empty()) text += ", ";
    if (name.rfind(kTimePer, 0) == 0) {
      text += threeDigits(1e9 * value) + " ns a " + name.substr(kTimePer.size());
    } else if (value >= 1000.0) {
      text += name + " " + std::to_string(static_cast<long long>(value));
    } else {
      text += name + " " + threeDigits(value);
    }
  }
  std::replace(text.begin(), text.end(), '_', ' ');
  return text;
}

// What of PCL does the same: of the same name, or of the stage's.
const Measurement* ofPcl(const Program& program, const std::string& stage) {
  for (const std::string& name : {stage, stage.substr(0, stage.find('/'))}) {
    for (const auto& [pcl_stage, measurement] : program.of_pcl) {
      if (pcl_stage == name) return &measurement;
    }
  }
  return nullptr;
}

// The own time of one thread, the clock's of several.
double milliseconds(const Measurement& measurement, int threads) {
  return threads > 1 ? measurement.real_ms : measurement.cpu_ms;
}

void print(const Program& program, const std::set<saw_ndt::internal::InstructionSet>& sets) {
  std::cout << "\n" << program.title << "\n\n| stage |";
  for (const saw_ndt::internal::InstructionSet set : sets)
    std::cout << " " << saw_ndt::internal::toString(set) << ", ms |";
  std::cout << " PCL, ms | PCL / ours | ours, 1 thread | PCL |\n|---|";
  for (std::size_t i = 0; i < sets.size() + 4; ++i) std::cout << "---|";
  std::cout << "\n";
  for (const Row& row : program.rows) {
    std::cout << "| " << row.stage << " |";
    const Measurement* best = nullptr;
    for (const saw_ndt::internal::InstructionSet set : sets) {
      std::string cell;
      const auto of_set = row.ours.find(set);
      if (of_set != row.ours.end()) {
        for (const auto& [threads, measurement] : of_set->second) {
          cell += (cell.empty() ? "" : " / ") + threeDigits(milliseconds(measurement, threads));
          if (threads == 1) best = &measurement;
        }
      }
      std::cout << " " << cell << " |";
    }
    const Measurement* const pcl = ofPcl(program, row.stage);
    if (pcl != nullptr && best != nullptr) {
      std::cout << " " << threeDigits(pcl->cpu_ms) << " | " << threeDigits(pcl->cpu_ms / best->cpu_ms) << " |";
    } else {
      std::cout << " | |";
    }
    std::cout << " " << (best != nullptr ? countersOf(*best) : "") << " | " << (pcl != nullptr ? countersOf(*pcl) : "")
              << " |\n";
  }
  for (const auto& [stage, measurement] : program.of_pcl) {
    const bool beside_ours = std::any_of(program.rows.begin(), program.rows.end(), [&, &name = stage](const Row& row) {
      return row.stage == name || row.stage.substr(0, row.stage.find('/')) == name;
    });
    if (beside_ours) continue;
    std::cout << "| " << kPcl << stage << " |";
    for (std::size_t i = 0; i < sets.size(); ++i) std::cout << " |";
    std::cout << " " << threeDigits(measurement.cpu_ms) << " | | | " << countersOf(measurement) << " |\n";
  }
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> files;
  saw_ndt::AppOptions app(
      "benchmark_tables",
      "Prints the JSON files of Google Benchmark programs as Markdown tables: the time of every stage for each "
      "instruction set by one thread and by two, PCL's by one, and PCL's by ours of one thread with the best "
      "instructions. One thread is timed by its own CPU time, two by the clock.");
  app.addPositionalList("FILE", &files, "written with --benchmark_out=FILE, medians where there are repetitions");
  return saw_ndt::runApp(argc, argv, app, [&] {
    std::vector<Program> programs;
    std::set<saw_ndt::internal::InstructionSet> sets;
    for (const std::string& file : files) {
      programs.push_back(read(file));
      for (const Row& row : programs.back().rows) {
        for (const auto& of_set : row.ours) sets.insert(of_set.first);
      }
    }
    std::cout << "Milliseconds of one thread / two; PCL has one.\n";
    for (const Program& program : programs) print(program, sets);
  });
}
