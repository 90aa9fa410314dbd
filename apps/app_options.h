#pragma once

#include <cstddef>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

namespace saw_ndt {

/// The command line is wrong; runApp() answers it with exit code 2.
class UsageError : public std::runtime_error {
 public:
  explicit UsageError(const std::string& what);
};

/// The command line of an app: files first, then options, each bound to a variable whose value is the default.
///
/// `-name value`, `--name value`, `-name=value` and `--name=value` are all taken, exact names only; values may start
/// with a minus sign. Every app has `-h`, `-help`, `-config FILE` and `-threads N` beside its own. A config file has
/// `name = value` lines and '#' comments; what the command line says wins over it.
class AppOptions {
 public:
  /// @param name         of the app
  /// @param description  one paragraph for the help
  AppOptions(std::string name, std::string description);

  /// Declares the next file name or the like; optional ones come after all others.
  void addPositional(const std::string& name, std::string* value, const std::string& help, bool optional = false);
  /// Declares one or more such names. There is one list at most; those that are declared behind it are the last names.
  void addPositionalList(const std::string& name, std::vector<std::string>* values, const std::string& help);

  // The placeholder stands for the value in the help and states its unit, such as METRES.
  void addOption(const std::string& name, double* value, const std::string& placeholder, const std::string& help);
  void addOption(const std::string& name, int* value, const std::string& placeholder, const std::string& help);
  void addOption(const std::string& name, std::string* value, const std::string& placeholder, const std::string& help);
  /// Numbers separated by commas: as many as *value has, or any number where it is empty.
  void addOption(const std::string& name, std::vector<double>* value, const std::string& placeholder,
                 const std::string& help);
  /// Words separated by commas, none of them empty.
  void addOption(const std::string& name, std::vector<std::string>* value, const std::string& placeholder,
                 const std::string& help);
  /// A switch, off unless named; in a config file `name = true`.
  void addFlag(const std::string& name, bool* value, const std::string& help);
  /// One of a few words.
  void addChoice(const std::string& name, std::string* value, const std::vector<std::string>& choices,
                 const std::string& help);

  /// Sets the bound variables. Throws UsageError that names what is wrong, and Error where the config file cannot be
  /// read. Returns false where the help is asked for; then nothing is checked to be complete.
  bool parse(int argc, const char* const* argv);

  const std::string& name() const { return name_; }
  /// What -h prints.
  std::string help() const;
  /// -threads: 1 or more; all cores unless stated.
  int threads() const { return threads_; }
  /// Whether the command line or the config file states an option.
  bool isGiven(const std::string& name) const;

 private:
  struct Positional {
    std::string name;
    std::string help;
    bool optional;
    std::string* value;
    std::vector<std::string>* list;
  };
  struct Option {
    std::string name;
    std::string placeholder;  ///< empty: a flag
    std::string help;
    std::string default_text;
    std::function<void(const std::string& text)> set;  ///< throws UsageError
    bool given = false;
  };

  void add(const std::string& name, const std::string& placeholder, const std::string& help,
           const std::string& default_text, std::function<void(const std::string&)> set);
  Option& find(const std::string& name);
  bool namesAnOption(const std::string& text) const;
  void setPositionals(const std::vector<std::string>& values);
  void readConfig(const std::string& path);

  std::string name_;
  std::string description_;
  std::vector<Positional> positionals_;
  std::vector<Option> options_;
  std::string config_;
  int threads_;
};

/// The numbers, separated by commas, of an option's text. @throws UsageError that names the option unless all are
/// finite and there are `count` of them, or any number for 0
std::vector<double> parseNumbers(const std::string& option, const std::string& text, std::size_t count);

/// Prints a line on stderr, "app: warning: message"; the work goes on.
void warn(const AppOptions& app, const std::string& message);

/// Parses the command line, does the work and returns the exit code: 0 done (or help printed), 1 the work threw, 2
/// wrong usage. Errors are one line on stderr, "app: message".
int runApp(int argc, const char* const* argv, AppOptions& app, const std::function<void()>& work);

/// The result of `check()`, whose std::invalid_argument (a value out of its range) becomes a UsageError.
template <typename Check>
auto checkedUsage(Check check) {
  try {
    return check();
  } catch (const std::invalid_argument& error) {
    throw UsageError(error.what());
  }
}

}  // namespace saw_ndt
