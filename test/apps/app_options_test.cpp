#include "app_options.h"

#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <iostream>
#include <sstream>
#include <thread>

#include "progress_bar.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

/// Collects what goes to a stream.
class Capture {
 public:
  explicit Capture(std::ostream& stream) : stream_(stream), old_(stream.rdbuf(text_.rdbuf())) {}
  ~Capture() { stream_.rdbuf(old_); }
  Capture(const Capture&) = delete;
  Capture& operator=(const Capture&) = delete;
  std::string text() const { return text_.str(); }

 private:
  std::ostringstream text_;
  std::ostream& stream_;
  std::streambuf* old_;
};

/// An app with an option of every kind.
struct TestApp {
  TestApp() : app("saw_ndt_test", "Does nothing at length.") {
    app.addPositional("INPUT", &input, "what to read");
    app.addPositional("OUTPUT", &output, "what to write", true);
    app.addOption("resolution", &resolution_m, "METRES", "edge of a voxel");
    app.addOption("step", &step, "N", "steps to take");
    app.addOption("scans", &scans, "SLICE", "scans to use");
    app.addOption("guess", &guess, "X,Y,Z", "first guess");
    app.addFlag("json", &json, "print JSON");
    app.addChoice("method", &method, {"weighted", "classical"}, "how to register");
  }

  int run(
      const std::vector<std::string>& arguments, const std::function<void()>& work = [] {}) {
    std::vector<const char*> argv{"saw_ndt_test"};
    for (const std::string& argument : arguments) argv.push_back(argument.c_str());
    const Capture out(std::cout);
    const Capture err(std::cerr);
    const int exit_code = runApp(static_cast<int>(argv.size()), argv.data(), app, work);
    printed = out.text();
    errors = err.text();
    return exit_code;
  }

  AppOptions app;
  std::string input;
  std::string output;
  double resolution_m = 1.5;
  int step = 2;
  std::string scans = ":";
  std::vector<double> guess{0.0, 0.0, 0.0};
  bool json = false;
  std::string method = "weighted";
  std::string printed;
  std::string errors;
};

TEST(AppOptions, DefaultsStayWithoutOptions) {
  TestApp t;
  EXPECT_EQ(t.run({"in.bin"}), 0) << t.errors;
  EXPECT_EQ(t.input, "in.bin");
  EXPECT_EQ(t.output, "");
  EXPECT_EQ(t.resolution_m, 1.5);
  EXPECT_FALSE(t.json);
  EXPECT_EQ(t.app.threads(), std::max(1, static_cast<int>(std::thread::hardware_concurrency())));
  EXPECT_FALSE(t.app.isGiven("resolution"));
  EXPECT_EQ(t.printed + t.errors, "");
}

TEST(AppOptions, OneAndTwoDashesAndEqualSigns) {
  for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
           {"in", "out", "-resolution", "0.5", "-step", "3", "-json", "-method", "classical", "-threads", "3"},
           {"in", "out", "--resolution", "0.5", "--step", "3", "--json", "--method", "classical", "--threads", "3"},
           {"-resolution=0.5", "--step=3", "in", "-method=classical", "-json", "out", "-threads=3"}}) {
    TestApp t;
    EXPECT_EQ(t.run(arguments), 0) << t.errors;
    EXPECT_EQ(t.input, "in");
    EXPECT_EQ(t.output, "out");
    EXPECT_EQ(t.resolution_m, 0.5);
    EXPECT_EQ(t.step, 3);
    EXPECT_TRUE(t.json);
    EXPECT_EQ(t.method, "classical");
    EXPECT_EQ(t.app.threads(), 3);
    EXPECT_TRUE(t.app.isGiven("resolution"));
    EXPECT_FALSE(t.app.isGiven("scans"));
  }
}

TEST(AppOptions, ValuesMayStartWithAMinusSign) {
  TestApp t;
  EXPECT_EQ(t.run({"in", "-guess", "-1,0,-2.5e-1", "-scans", "-5:", "-resolution", "-3", "-step=-2"}), 0) << t.errors;
  EXPECT_EQ(t.guess, (std::vector<double>{-1.0, 0.0, -0.25}));
  EXPECT_EQ(t.scans, "-5:");
  EXPECT_EQ(t.resolution_m, -3.0);
  EXPECT_EQ(t.step, -2);
}

TEST(AppOptions, WrongUsageIsNamedOnOneLine) {
  const struct {
    std::vector<std::string> arguments;
    std::string reason;
  } cases[] = {
      {{}, "missing INPUT"},
      {{"a", "b", "c"}, "superfluous argument 'c'"},
      {{"a", "-foo"}, "unknown option -foo"},
      {{"a", "--foo", "1"}, "unknown option --foo"},
      {{"a", "-foo=1"}, "unknown option -foo=1"},
      {{"a", "-res", "1"}, "unknown option -res"},
      {{"a", "--res", "1"}, "unknown option --res"},
      {{"a", "-j"}, "unknown option -j"},
      {{"a", "-resolution"}, "resolution needs a value"},
      {{"a", "-resolution="}, "resolution needs a value"},
      {{"a", "-scans", "-json"}, "scans needs a value"},
      {{"a", "--scans", "--json"}, "scans needs a value"},
      {{"a", "-resolution", "1.5x"}, "option -resolution: '1.5x' is no finite number"},
      {{"a", "-resolution", "nan"}, "'nan' is no finite number"},
      {{"a", "-resolution", "1,5"}, "'1,5' is no finite number"},
      {{"a", "-step", "1.5"}, "option -step: '1.5' is no whole number"},
      {{"a", "-step", "99999999999"}, "'99999999999' is no whole number"},
      {{"a", "-guess", "1,2"}, "'1,2' has 2 numbers, where 3 are needed"},
      {{"a", "-guess", "1,,2"}, "'' is no finite number"},
      {{"a", "-json=1"}, "json takes no value"},
      {{"a", "-method", "none"}, "'none' is none of weighted, classical"},
      {{"a", "-threads", "0"}, "option -threads: 0 is less than 1"},
      {{"a", "-threads", "-2"}, "option -threads: -2 is less than 1"},
      {{"a", "-step", "1", "--step", "2"}, "option -step is given twice"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.reason);
    TestApp t;
    EXPECT_EQ(t.run(c.arguments, [] { ADD_FAILURE() << "work was done"; }), 2);
    EXPECT_EQ(t.errors.rfind("saw_ndt_test: ", 0), 0U) << t.errors;
    EXPECT_NE(t.errors.find(c.reason), std::string::npos) << t.errors;
    EXPECT_EQ(std::count(t.errors.begin(), t.errors.end(), '\n'), 1);
    EXPECT_EQ(t.printed, "");
  }
}

TEST(AppOptions, HelpListsEverythingWithDefaults) {
  for (const std::string flag : {"-h", "--h", "-help", "--help"}) {
    TestApp t;
    EXPECT_EQ(t.run({flag}, [] { ADD_FAILURE() << "work was done"; }), 0) << t.errors;
    for (const std::string part :
         {"Usage: saw_ndt_test INPUT [OUTPUT] [options]", "Does nothing at length.", "what to read",
          "-resolution METRES", "edge of a voxel (default: 1.5)", "-guess X,Y,Z", "(default: 0,0,0)", "-json",
          "weighted, classical (default: weighted)", "-threads N", "-config FILE", "-h, -help"}) {
      EXPECT_NE(t.printed.find(part), std::string::npos) << part << " is missing in\n" << t.printed;
    }
  }
}

TEST(AppOptions, ConfigFileGivesWayToTheCommandLine) {
  const TemporaryFolder folder;
  const std::string config =
      folder.write("a.cfg", "# a comment\nresolution = 0.25\nstep=7  # of many\njson = true\nguess = -1,2,3\n\n")
          .string();
  for (const std::string dashes : {"-", "--"}) {
    TestApp t;
    EXPECT_EQ(t.run({"in", "-step", "9", dashes + "config", config}), 0) << t.errors;
    EXPECT_EQ(t.resolution_m, 0.25);
    EXPECT_EQ(t.step, 9);
    EXPECT_TRUE(t.json);
    EXPECT_EQ(t.guess, (std::vector<double>{-1.0, 2.0, 3.0}));
    EXPECT_TRUE(t.app.isGiven("resolution"));
  }
}

TEST(AppOptions, AConfigFileMayBeginWithAByteOrderMark) {
  const TemporaryFolder folder;
  TestApp t;
  EXPECT_EQ(t.run({"in", "-config", folder.write("a.cfg", "\xEF\xBB\xBFstep = 7\n").string()}), 0) << t.errors;
  EXPECT_EQ(t.step, 7);
}

TEST(AppOptions, WhatAFileSaysReachesNoTerminalAsACommand) {
  const TemporaryFolder folder;
  TestApp config, work;
  EXPECT_EQ(config.run({"in", "-config", folder.write("a.cfg", "st\x1b[2Jep = 7\n").string()}), 2);
  EXPECT_NE(config.errors.find("unknown option -st\\x1b[2Jep"), std::string::npos) << config.errors;
  EXPECT_EQ(work.run({"in"}, [] { throw std::invalid_argument("name = \x1b[2J\nis none"); }), 1);
  EXPECT_EQ(work.errors, "saw_ndt_test: name = \\x1b[2J is none\n");
}

TEST(AppOptions, ConfigFileErrorsNameTheFile) {
  const TemporaryFolder folder;
  const struct {
    std::string content;
    std::string reason;
  } cases[] = {{"foo = 1\n", "unknown option -foo"},
               {"res = 1\n", "unknown option -res"},
               {"resolution = wide\n", "'wide' is no finite number"},
               {"resolution\n", "resolution"},
               {"json = maybe\n", "'maybe' is neither true nor false"},
               {"step = 1\nstep = 2\n", "given twice"},
               {"%invalid_line%\n", "'%invalid_line%' is no line of `name = value`"},
               {"config = b.cfg\n", "for the command line alone"},
               {"INPUT = b\n", "unknown option -INPUT"}};
  for (const auto& c : cases) {
    const std::string config = folder.write("a.cfg", c.content).string();
    TestApp t;
    EXPECT_EQ(t.run({"in", "-config", config}), 2);
    EXPECT_NE(t.errors.find(config), std::string::npos) << t.errors;
    EXPECT_NE(t.errors.find(c.reason), std::string::npos) << t.errors;
  }
  TestApp t;
  EXPECT_EQ(t.run({"in", "-config", "/none.cfg"}), 1);
  EXPECT_NE(t.errors.find("/none.cfg: No such file"), std::string::npos) << t.errors;
}

TEST(AppOptions, WorkThatFails) {
  TestApp t;
  EXPECT_EQ(t.run({"in"}, [] { throw Error("a.bin", "offset 16", "cut\nshort"); }), 1);
  EXPECT_EQ(t.errors, "saw_ndt_test: a.bin: offset 16: cut short\n");
  EXPECT_EQ(TestApp().run({"in"}, [] { throw std::bad_alloc(); }), 1);
  EXPECT_EQ(TestApp().run({"in"}, [] { throw UsageError("-guess does not go with -scans"); }), 2);
  EXPECT_EQ(TestApp().run({"in"}, [] { checkedUsage([] { checkOption(false, "resolution", -1, "greater than 0"); }); }),
            2);
}

TEST(AppOptions, ListOfPositionals) {
  std::vector<std::string> sequences;
  AppOptions app("saw_ndt_test", "Takes many.");
  app.addPositionalList("SEQUENCE", &sequences, "drives");
  const char* argv[] = {"saw_ndt_test", "00", "01", "-threads", "1", "03"};
  EXPECT_TRUE(app.parse(6, argv));
  EXPECT_EQ(sequences, (std::vector<std::string>{"00", "01", "03"}));
  EXPECT_NE(app.help().find("Usage: saw_ndt_test SEQUENCE... [options]"), std::string::npos);
  EXPECT_THROW(app.parse(1, argv), UsageError);
}

TEST(ProgressBar, IsSilentWhereStderrIsNoTerminal) {
  const Capture err(std::cerr);
  {
    ProgressBar bar(3);
    for (int i = 0; i < 5; ++i) bar.step();
  }
  if (isatty(STDERR_FILENO) == 1) GTEST_SKIP() << "stderr is a terminal";
  EXPECT_EQ(err.text(), "");
}

}  // namespace
}  // namespace saw_ndt
