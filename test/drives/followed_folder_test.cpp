#include "drives/followed_folder.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

#include "expect_throws.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

constexpr int kAnyNumber = 1000;

std::string pcdScan(double x) {
  return "VERSION 0.7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 1\nHEIGHT 1\nPOINTS 1\nDATA ascii\n" +
         std::to_string(x) + " 1 2\n";
}

float firstX(const RecordedScan& scan) { return scan.points.at(0).x; }

TEST(FollowedFolder, ScansAreGivenAsTheyComeAndWhatIsNoScanIsCounted) {
  const TemporaryFolder folder;
  const auto source = followFolder(folder.path(), 0, kAnyNumber);
  RecordedScan scan;
  for (int i = 0; i < 3; ++i) {
    folder.write("notes.txt", "no scan");
    const std::string name = "170000000" + std::to_string(i) + ".5.pcd";
    folder.write(name, pcdScan(10.0 + i));
    ASSERT_TRUE(source->next(scan));
    EXPECT_EQ(scan.name, name);
    EXPECT_EQ(scan.number, i);
    EXPECT_EQ(scan.stamp_s, 1700000000.5 + i);
    EXPECT_EQ(firstX(scan), 10.0F + static_cast<float>(i));
  }
  EXPECT_EQ(source->leftOut(), 0U);
  EXPECT_EQ(source->rejected(), 3U);
  EXPECT_FALSE(source->scanCount().has_value());
}

TEST(FollowedFolder, AFileIsTakenWhenItIsWholeAlsoOneThatIsMovedIn) {
  const TemporaryFolder folder, elsewhere;
  const auto source = followFolder(folder.path(), 0, kAnyNumber);
  std::thread writer([&] {
    std::ofstream stream(folder.path() / "1.pcd");
    const std::string text = pcdScan(1.0);
    stream << text.substr(0, 30) << std::flush;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
    stream << text.substr(30);
    stream.close();
    std::filesystem::rename(elsewhere.write("moved", pcdScan(2.0)), folder.path() / "2.pcd");
  });
  RecordedScan scan;
  for (const float x : {1.0F, 2.0F}) {
    ASSERT_TRUE(source->next(scan));
    EXPECT_EQ(scan.failure, "");
    EXPECT_EQ(firstX(scan), x);
  }
  writer.join();
}

TEST(FollowedFolder, ALateCallerGetsTheNewestAndTheOthersAreCounted) {
  const TemporaryFolder folder;
  for (const char* name : {"0.pcd", "9.pcd", "10.pcd"}) folder.write(name, pcdScan(std::stod(name)));
  const auto source = followFolder(folder.path(), 0, 2);
  RecordedScan scan;
  ASSERT_TRUE(source->next(scan));
  EXPECT_EQ(firstX(scan), 10.0F);
  EXPECT_EQ(scan.number, 2);
  EXPECT_EQ(source->leftOut(), 2U);
  for (const char* name : {"11.pcd", "12.pcd"}) folder.write(name, pcdScan(std::stod(name)));
  for (const float x : {11.0F, 12.0F}) {
    ASSERT_TRUE(source->next(scan));
    EXPECT_EQ(firstX(scan), x);
  }
  EXPECT_EQ(source->leftOut(), 2U);
}

TEST(FollowedFolder, ADamagedScanIsToldAndTheNextOneRead) {
  const TemporaryFolder folder;
  const auto source = followFolder(folder.path(), 0, kAnyNumber);
  folder.write("1.pcd", "hello\n");
  folder.write("2.pcd", pcdScan(2.0));
  RecordedScan scan;
  ASSERT_TRUE(source->next(scan));
  EXPECT_NE(scan.failure.find("1.pcd"), std::string::npos);
  EXPECT_TRUE(scan.points.empty());
  ASSERT_TRUE(source->next(scan));
  EXPECT_EQ(scan.failure, "");
}

TEST(FollowedFolder, StoppingEndsAWaitingCaller) {
  const TemporaryFolder folder;
  const auto source = followFolder(folder.path(), 0, kAnyNumber);
  std::thread stopper([&] {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));
    source->stop();
  });
  RecordedScan scan;
  EXPECT_FALSE(source->next(scan));
  stopper.join();
  folder.write("1.pcd", pcdScan(1.0));
  EXPECT_FALSE(source->next(scan));
}

TEST(FollowedFolder, WhatIsNoFolderIsRefused) {
  const TemporaryFolder folder;
  expectThrows<Error>([&] { followFolder(folder.path() / "none", 0, 1); }, {"none", "No such file"});
  const auto file = folder.write("a.pcd", pcdScan(1.0));
  expectThrows<Error>([&] { followFolder(file, 0, 1); }, {"a.pcd", "Not a directory"});
}

}  // namespace
}  // namespace saw_ndt::internal
