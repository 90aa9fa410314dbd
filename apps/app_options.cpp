#include "app_options.h"

#include <algorithm>
#include <boost/program_options/cmdline.hpp>
#include <boost/program_options/errors.hpp>
#include <boost/program_options/options_description.hpp>
#include <boost/program_options/parsers.hpp>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <iostream>
#include <new>
#include <set>
#include <sstream>
#include <thread>
#include <utility>

#include "common/input_file.h"
#include "common/instruction_set.h"
#include "common/printable.h"
#include "common/program_signals.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt {

using namespace internal;

namespace po = boost::program_options;

namespace {

constexpr std::size_t kHelpWidth = 100;

template <typename Number>
Number parseNumber(const std::string& option, const std::string& text, const char* kind) {
  const char* first = text.data() + (text.size() > 1 && text[0] == '+' && text[1] != '-' ? 1 : 0);
  const char* last = text.data() + text.size();
  Number number{};
  const auto [end, error] = std::from_chars(first, last, number);
  if (error != std::errc() || end != last || !std::isfinite(static_cast<double>(number))) {
    throw UsageError("option -" + option + ": '" + text + "' is no " + kind);
  }
  return number;
}

std::string textOf(double value) {
  std::ostringstream text;
  text << value;
  return text.str();
}

std::string textOf(const std::vector<double>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "" : ",") + textOf(value);
  return text;
}

std::string textOf(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : ",") + word;
  return text;
}

std::vector<std::string> splitAtCommas(const std::string& text) {
  std::vector<std::string> parts(1);
  for (const char c : text) {
    if (c == ',') {
      parts.emplace_back();
    } else {
      parts.back() += c;
    }
  }
  return parts;
}

bool parseSwitch(const std::string& option, const std::string& text) {
  if (text == "true") return true;
  if (text == "false") return false;
  throw UsageError("option -" + option + ": '" + text + "' is neither true nor false");
}

/// Words broken at kHelpWidth, each line after the first indented.
std::string wrapped(const std::string& text, std::size_t indent) {
  std::istringstream words(text);
  std::string result;
  std::size_t column = indent;
  for (std::string word; words >> word;) {
    if (!result.empty() && column + 1 + word.size() > kHelpWidth) {
      result += "\n" + std::string(indent, ' ');
      column = indent;
    } else if (!result.empty()) {
      result += ' ';
      ++column;
    }
    result += word;
    column += word.size();
  }
  return result;
}

/// One entry of the help in two columns.
std::string helpEntry(const std::string& term, const std::string& text, std::size_t width) {
  return "  " + term + std::string(width - term.size() + 2, ' ') + wrapped(text, width + 4) + "\n";
}

}  // namespace

UsageError::UsageError(const std::string& what) : std::runtime_error(internal::printable(what)) {}

AppOptions::AppOptions(std::string name, std::string description)
    : name_(std::move(name)),
      description_(std::move(description)),
      threads_(std::max(1, static_cast<int>(std::thread::hardware_concurrency()))) {
  add("config", "FILE", "read options from `name = value` lines; the command line wins", "",
      [this](const std::string& text) { config_ = text; });
  add("threads", "N", "number of threads", "all cores, " + std::to_string(threads_), [this](const std::string& text) {
    threads_ = parseNumber<int>("threads", text, "whole number");
    if (threads_ < 1) throw UsageError("option -threads: " + text + " is less than 1");
  });
}

void AppOptions::addPositional(const std::string& name, std::string* value, const std::string& help, bool optional) {
  positionals_.push_back({name, help, optional, value, nullptr});
}

void AppOptions::addPositionalList(const std::string& name, std::vector<std::string>* values, const std::string& help) {
  positionals_.push_back({name, help, false, nullptr, values});
}

void AppOptions::add(const std::string& name, const std::string& placeholder, const std::string& help,
                     const std::string& default_text, std::function<void(const std::string&)> set) {
  options_.push_back({name, placeholder, help, default_text, std::move(set)});
}

void AppOptions::addOption(const std::string& name, double* value, const std::string& placeholder,
                           const std::string& help) {
  add(name, placeholder, help, textOf(*value),
      [name, value](const std::string& text) { *value = parseNumber<double>(name, text, "finite number"); });
}

void AppOptions::addOption(const std::string& name, int* value, const std::string& placeholder,
                           const std::string& help) {
  add(name, placeholder, help, std::to_string(*value),
      [name, value](const std::string& text) { *value = parseNumber<int>(name, text, "whole number"); });
}

void AppOptions::addOption(const std::string& name, std::string* value, const std::string& placeholder,
                           const std::string& help) {
  add(name, placeholder, help, *value, [value](const std::string& text) { *value = text; });
}

std::vector<double> parseNumbers(const std::string& option, const std::string& text, std::size_t count) {
  std::vector<double> numbers;
  for (const std::string& part : splitAtCommas(text)) {
    numbers.push_back(parseNumber<double>(option, part, "finite number"));
  }
  if (count != 0 && numbers.size() != count) {
    throw UsageError("option -" + option + ": '" + text + "' has " + std::to_string(numbers.size()) +
                     " numbers, where " + std::to_string(count) + " are needed");
  }
  return numbers;
}

void AppOptions::addOption(const std::string& name, std::vector<double>* value, const std::string& placeholder,
                           const std::string& help) {
  add(name, placeholder, help, textOf(*value),
      [name, value, count = value->size()](const std::string& text) { *value = parseNumbers(name, text, count); });
}

void AppOptions::addOption(const std::string& name, std::vector<std::string>* value, const std::string& placeholder,
                           const std::string& help) {
  add(name, placeholder, help, textOf(*value), [name, value](const std::string& text) {
    *value = splitAtCommas(text);
    if (std::find(value->begin(), value->end(), "") != value->end()) {
      throw UsageError("option -" + name + ": '" + text + "' has an empty word");
    }
  });
}

void AppOptions::addFlag(const std::string& name, bool* value, const std::string& help) {
  add(name, "", help, *value ? "on" : "off",
      [name, value](const std::string& text) { *value = parseSwitch(name, text); });
}

void AppOptions::addChoice(const std::string& name, std::string* value, const std::vector<std::string>& choices,
                           const std::string& help) {
  std::string list;
  for (const std::string& choice : choices) list += (list.empty() ? "" : ", ") + choice;
  add(name, "WORD", help + ": " + list, *value, [=](const std::string& text) {
    if (std::find(choices.begin(), choices.end(), text) == choices.end()) {
      throw UsageError("option -" + name + ": '" + text + "' is none of " + list);
    }
    *value = text;
  });
}

AppOptions::Option& AppOptions::find(const std::string& name) {
  const auto option = std::find_if(options_.begin(), options_.end(), [&](const Option& o) { return o.name == name; });
  if (option == options_.end()) throw UsageError("unknown option -" + name);
  return *option;
}

bool AppOptions::isGiven(const std::string& name) const {
  return std::any_of(options_.begin(), options_.end(), [&](const Option& o) { return o.name == name && o.given; });
}

bool AppOptions::namesAnOption(const std::string& text) const {
  const std::size_t dashes = text.find_first_not_of('-');
  return (dashes == 1 || dashes == 2) && std::any_of(options_.begin(), options_.end(), [&](const Option& option) {
           return text.compare(dashes, std::string::npos, option.name) == 0;
         });
}

bool AppOptions::parse(int argc, const char* const* argv) {
  po::options_description description;
  description.add_options()("help", "")("h", "");
  for (const Option& option : options_) {
    // Boost splits the command line; values stay text, so that every message about one reads alike.
    if (option.placeholder.empty()) {
      description.add_options()(option.name.c_str(), "");
    } else {
      description.add_options()(option.name.c_str(), po::value<std::string>(), "");
    }
  }
  namespace style = po::command_line_style;
  const int exact_names =
      style::allow_long | style::long_allow_adjacent | style::long_allow_next | style::allow_long_disguise;
  std::vector<po::option> parsed;
  try {
    parsed = po::command_line_parser(argc, argv).options(description).style(exact_names).run().options;
  } catch (const po::unknown_option& error) {
    throw UsageError("unknown option " + error.get_option_name());
  } catch (const po::invalid_command_line_syntax& error) {
    const std::string token = error.get_option_name();
    const std::string name = token.substr(0, token.find('='));
    const bool missing = error.kind() == po::invalid_syntax::missing_parameter ||
                         error.kind() == po::invalid_syntax::empty_adjacent_parameter;
    throw UsageError("option " + name + (missing ? " needs a value" : " takes no value"));
  } catch (const po::error& error) {
    throw UsageError(error.what());
  }

  std::vector<std::string> positional_values;
  for (const po::option& item : parsed) {
    if (item.string_key == "h" || item.string_key == "help") return false;
  }
  for (const po::option& item : parsed) {
    if (item.string_key.empty()) {
      const std::string& text = item.value.front();
      // What looks like an option and is none: Boost takes it for a file name.
      if (text.size() > 1 && text.front() == '-') throw UsageError("unknown option " + text);
      positional_values.push_back(text);
      continue;
    }
    Option& option = find(item.string_key);
    if (option.given) throw UsageError("option -" + option.name + " is given twice");
    option.given = true;
    // Values may start with a minus sign, but the name of another option shows that the value was forgotten.
    if (!option.placeholder.empty() && namesAnOption(item.value.front())) {
      throw UsageError("option -" + option.name + " needs a value");
    }
    option.set(option.placeholder.empty() ? "true" : item.value.front());
  }
  setPositionals(positional_values);
  if (isGiven("config")) readConfig(config_);
  return true;
}

void AppOptions::setPositionals(const std::vector<std::string>& values) {
  std::size_t taken = 0;
  for (const Positional& positional : positionals_) {
    if (taken == values.size()) {
      if (!positional.optional) throw UsageError("missing " + positional.name);
    } else if (positional.list != nullptr) {
      // Those behind the list have a value each.
      const auto behind = static_cast<std::size_t>(&positionals_.back() - &positional);
      const std::size_t end = std::max(taken + 1, values.size() - std::min(behind, values.size()));
      positional.list->assign(values.begin() + static_cast<std::ptrdiff_t>(taken),
                              values.begin() + static_cast<std::ptrdiff_t>(end));
      taken = end;
    } else {
      *positional.value = values[taken++];
    }
  }
  if (taken < values.size()) throw UsageError("superfluous argument '" + values[taken] + "'");
}

void AppOptions::readConfig(const std::string& path) {
  std::ifstream stream = openTextFile(path);
  std::vector<po::option> parsed;
  try {
    // Unknown names are let through here and refused below, in the same words as on the command line.
    parsed = po::parse_config_file(stream, po::options_description(), true).options;
  } catch (const po::invalid_config_file_syntax& error) {
    // Its what() would look for placeholders in what it quotes, for ever where the line itself holds one.
    throw UsageError(path + ": '" + error.tokens() + "' is no line of `name = value`");
  } catch (const po::error& error) {
    throw UsageError(path + ": " + error.what());
  }
  std::set<std::string> seen;
  for (const po::option& item : parsed) {
    try {
      Option& option = find(item.string_key);
      if (option.name == "config") throw UsageError("option -config is for the command line alone");
      if (!seen.insert(option.name).second) throw UsageError("option -" + option.name + " is given twice");
      if (option.given) continue;
      option.set(item.value.front());
    } catch (const UsageError& error) {
      throw UsageError(path + ": " + error.what());
    }
  }
  for (Option& option : options_) option.given = option.given || seen.count(option.name) > 0;
}

std::string AppOptions::help() const {
  std::string usage = "Usage: " + name_;
  std::size_t width = 0;
  for (const Positional& positional : positionals_) {
    const std::string term = positional.name + (positional.list != nullptr ? "..." : "");
    usage += positional.optional ? " [" + term + "]" : " " + term;
    width = std::max(width, positional.name.size());
  }
  const auto termOf = [](const Option& option) {
    return "-" + option.name + (option.placeholder.empty() ? "" : " " + option.placeholder);
  };
  for (const Option& option : options_) width = std::max(width, termOf(option).size());

  std::string text = usage + " [options]\n\n" + wrapped(description_, 0) + "\n\n";
  for (const Positional& positional : positionals_) text += helpEntry(positional.name, positional.help, width);
  text += positionals_.empty() ? "Options:\n" : "\nOptions:\n";
  // The app's own options first; the common ones were added before them.
  std::vector<Option> ordered = options_;
  std::stable_partition(ordered.begin(), ordered.end(),
                        [](const Option& option) { return option.name != "config" && option.name != "threads"; });
  for (const Option& option : ordered) {
    const std::string default_text = option.default_text.empty() ? "none" : option.default_text;
    const bool stated = option.help.find("(default: ") != std::string::npos;  // in words, where it is no fixed value
    text += helpEntry(termOf(option), option.help + (stated ? "" : " (default: " + default_text + ")"), width);
  }
  return text + helpEntry("-h, -help", "print this text", width);
}

void warn(const AppOptions& app, const std::string& message) {
  std::cerr << app.name() << ": warning: " << internal::printableLine(message) << std::endl;
}

int runApp(int argc, const char* const* argv, AppOptions& app, const std::function<void()>& work) {
  const auto fail = [&](const std::string& message, int code) {
    std::cerr << app.name() << ": " << internal::printableLine(message) << std::endl;
    return code;
  };
  handleProgramSignals();
  try {
    if (app.parse(argc, argv)) {
      instructionSet();  // throws where the environment asks for one that there is not
      work();
    } else {
      std::cout << app.help();
    }
    if (!std::cout.flush()) throw Error("standard output", "", "could not be written");
    return 0;
  } catch (const UsageError& error) {
    return fail(std::string(error.what()) + " (-h prints the usage)", 2);
  } catch (const std::bad_alloc&) {
    return fail("out of memory", 1);
  } catch (const std::filesystem::filesystem_error& error) {
    return fail(error.path1().string() + ": " + error.code().message(), 1);
  } catch (const std::exception& error) {
    return fail(error.what(), 1);
  }
}

}  // namespace saw_ndt
