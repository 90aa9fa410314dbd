#include "report/benchmark_report.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <iterator>

#include "benchmark_fixtures.h"
#include "report/benchmark_pictures.h"
#include "report/gnuplot.h"
#include "report/html.h"
#include "report/method_colour.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt {
namespace {

std::string contentOf(const std::filesystem::path& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

/// Another PATH as long as this object lives.
class SearchPath {
 public:
  explicit SearchPath(const std::string& path) : earlier_(std::getenv("PATH")) { setenv("PATH", path.c_str(), 1); }
  ~SearchPath() { setenv("PATH", earlier_.c_str(), 1); }
  SearchPath(const SearchPath&) = delete;
  SearchPath& operator=(const SearchPath&) = delete;

 private:
  std::string earlier_;
};

/// The file without its pictures, whose bytes may look like anything.
std::string withoutPictures(std::string html) {
  for (std::size_t at = html.find(";base64,"); at != std::string::npos; at = html.find(";base64,", at + 1)) {
    html.erase(at + 8, html.find('"', at) - at - 8);
  }
  return html;
}

/// Expects that every element that is opened is closed in turn, and that nothing outside of the file is needed.
void expectSelfContained(const std::string& report) {
  const std::string html = withoutPictures(report);
  std::vector<std::string> open;
  for (std::size_t at = html.find('<'); at != std::string::npos; at = html.find('<', at + 1)) {
    const bool closes = html[at + 1] == '/';
    const std::size_t begin = at + (closes ? 2 : 1);
    const std::string name = html.substr(begin, html.find_first_of(" >\n", begin) - begin);
    if (name == "!DOCTYPE" || name == "meta" || name == "img") continue;
    if (!closes) {
      open.push_back(name);
      continue;
    }
    ASSERT_FALSE(open.empty()) << name;
    EXPECT_EQ(open.back(), name);
    open.pop_back();
  }
  EXPECT_TRUE(open.empty());
  EXPECT_EQ(html.find("http"), std::string::npos);
  EXPECT_EQ(html.find("href"), std::string::npos);
  EXPECT_EQ(html.find("url("), std::string::npos);
  EXPECT_EQ(html.find("<script"), std::string::npos);
  for (std::size_t at = html.find("src="); at != std::string::npos; at = html.find("src=", at + 1)) {
    EXPECT_EQ(html.substr(at, 10), "src=\"data:");
  }
}

class BenchmarkReport : public ::testing::Test {
 protected:
  std::string write(const std::vector<BenchmarkRun>& what) {
    return writeBenchmarkReport(folder.path(), what, benchmarkText(benchmarkTables(what), kHandMadeRecord, true));
  }
  std::string report() const { return contentOf(folder.path() / "report.html"); }
  static std::size_t imagesIn(const std::string& html) {
    std::size_t count = 0;
    for (std::size_t at = html.find("<img "); at != std::string::npos; at = html.find("<img ", at + 1)) ++count;
    return count;
  }

  TemporaryFolder folder;
  const std::vector<HandMadeMethod> methods{{"classical", 0.1, 20.0}, {"weighted", 0.05, 30.0, 1}, {"pcl-ndt", 2, 4e3}};
  const std::vector<BenchmarkRun> runs{handMadeRun("00", MapDrive::SAME, 30, methods),
                                       handMadeRun("it's <b>$1_x", MapDrive::OTHER, 30, methods)};
};

TEST_F(BenchmarkReport, ExplainsItselfAndShowsEveryDriveAndMethod) {
  if (!gnuplotFound()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_EQ(write(runs), "");
  const std::string html = report();
  expectSelfContained(html);
  for (const std::string part :
       {"<h2>00, map of the same drive</h2>", "<h2>it's &lt;b&gt;$1_x, map of another drive</h2>", "classical",
        "weighted", "pcl-ndt", "How to read it", "Some CPU &lt;fast&gt; &amp; cheap", "2026-01-31 12:00:00 UTC",
        "saw_ndt_benchmark 00 -output 'a b'", "Beside the paper"}) {
    EXPECT_NE(html.find(part), std::string::npos) << part;
  }
  EXPECT_EQ(imagesIn(html), 10U);
  for (const std::string name : {"map", "position_error", "yaw_error", "likelihood", "run_time"}) {
    const std::filesystem::path plots = folder.path() / "plots";
    const std::string png = contentOf(plots / ("00_same_" + name + ".png"));
    EXPECT_EQ(png.substr(1, 3), "PNG") << name;
    EXPECT_GT(png.size(), 5000U) << name;
    if (name != "map") {
      EXPECT_NE(contentOf(plots / ("00_same_" + name + ".svg")).find("<svg"), std::string::npos) << name;
    }
  }
  // Neither scripts nor messages stay behind: 5 PNG and 4 SVG a run.
  const auto plots = std::filesystem::directory_iterator(folder.path() / "plots");
  EXPECT_EQ(std::distance(plots, std::filesystem::directory_iterator()), 18);
}

TEST_F(BenchmarkReport, AStandingVehicleAndExactPosesCanBeDrawn) {
  if (!gnuplotFound()) GTEST_SKIP() << "gnuplot is not installed";
  EXPECT_EQ(write({handMadeRun("one", MapDrive::SAME, 1, {{"weighted", 0.0, 0.0}})}), "");
  EXPECT_EQ(imagesIn(report()), 5U);
}

TEST_F(BenchmarkReport, WithoutGnuplotItSaysSo) {
  {
    const SearchPath nowhere((folder.path() / "empty").string());
    EXPECT_NE(write(runs).find("gnuplot is not installed"), std::string::npos);
  }
  const std::string html = report();
  expectSelfContained(html);
  EXPECT_NE(html.find("gnuplot is not installed"), std::string::npos);
  EXPECT_EQ(imagesIn(html), 0U);
  EXPECT_NE(html.find("<td class=\"method\">weighted</td>"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder.path() / "plots"));
}

TEST_F(BenchmarkReport, WhereGnuplotFailsTheRestIsStillWritten) {
  const auto broken = folder.write("bin/gnuplot", "#!/bin/sh\necho 'no colours left' >&2\nexit 3\n");
  std::filesystem::permissions(broken, std::filesystem::perms::owner_all);
  {
    const SearchPath first(broken.parent_path().string() + ":" + std::getenv("PATH"));
    EXPECT_NE(write(runs).find("no colours left"), std::string::npos);
  }
  const std::string html = report();
  expectSelfContained(html);
  EXPECT_NE(html.find("This picture could not be drawn: gnuplot: 00_same_map: no colours left."), std::string::npos);
  EXPECT_EQ(imagesIn(html), 0U);
}

TEST(Gnuplot, TextsAndDataAreTakenLiterally) {
  EXPECT_EQ(gnuplotQuoted("it's `ls` \"$x\"\n"), "'it''s `ls` \"$x\" '");
  EXPECT_EQ(gnuplotData("$a", {{1.0, 2.0}, {0.5, -3.0}}), "$a << END_OF_DATA\n1 0.5 \n2 -3 \nEND_OF_DATA\n");
}

TEST(Gnuplot, MethodsHaveColoursOfTheirOwn) {
  std::vector<std::string> colours{methodColour("another")};
  for (const std::string& method : benchmarkMethodNames()) {
    EXPECT_EQ(std::count(colours.begin(), colours.end(), methodColour(method)), 0) << method;
    colours.push_back(methodColour(method));
  }
}

TEST(Html, Base64HasTheVectorsOfRfc4648) {
  const std::pair<const char*, const char*> vectors[] = {{"", ""},
                                                         {"f", "Zg=="},
                                                         {"fo", "Zm8="},
                                                         {"foo", "Zm9v"},
                                                         {"foob", "Zm9vYg=="},
                                                         {"fooba", "Zm9vYmE="},
                                                         {"foobar", "Zm9vYmFy"},
                                                         {"\xff\xfe", "//4="}};
  for (const auto& [bytes, text] : vectors) EXPECT_EQ(base64(bytes), text);
}

TEST(Html, EscapesWhatHasAMeaning) { EXPECT_EQ(htmlEscaped("<a b=\"c\">&"), "&lt;a b=&quot;c&quot;&gt;&amp;"); }

}  // namespace
}  // namespace saw_ndt
