#include <gtest/gtest.h>

#include "expect_throws.h"
#include "io/message_file.h"
#include "io/ros1_bag_bytes.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

class Ros1BagTest : public ::testing::Test {
 protected:
  std::unique_ptr<MessageFile> open(const std::string& bytes) const {
    return openMessageFile(folder_.write("file.bag", bytes));
  }
  static std::string textOf(ByteView bytes) {
    return std::string(reinterpret_cast<const char*>(bytes.data), bytes.size);
  }
  static std::vector<std::string> textsOf(MessageFile& file) {
    std::vector<std::uint32_t> topics;
    for (std::uint32_t i = 0; i < file.topics().size(); ++i) topics.push_back(i);
    std::vector<std::string> texts;
    for (const MessageEntry& entry : file.index(topics)) {
      try {
        texts.push_back(textOf(file.read(entry)));
        EXPECT_EQ(textOf(file.readHead(entry, 2)), texts.back().substr(0, 2));
      } catch (const Error&) {
        texts.push_back("damaged");
      }
    }
    return texts;
  }

  TemporaryFolder folder_;
  Ros1BagWriter writer_ = Ros1BagWriter({{"/points", "sensor_msgs/PointCloud2"}, {"/tf", "tf2_msgs/TFMessage"}})
                              .addChunk({{0, 5, 30, "third"}, {1, 5, 10, "first"}})
                              .addChunk({{0, 6, 0, "fourth"}, {0, 5, 20, "second"}});
};

using Texts = std::vector<std::string>;

TEST_F(Ros1BagTest, TopicsAndMessagesAreThoseOfTheBag) {
  const auto file = open(writer_.bytes());
  ASSERT_EQ(file->topics().size(), 2U);
  EXPECT_EQ(file->topics()[0].type, "sensor_msgs/PointCloud2");
  EXPECT_EQ(file->topics()[0].encoding, MessageEncoding::ROS1);
  EXPECT_EQ(file->topics()[0].messages, 3U);
  EXPECT_EQ(textsOf(*file), (Texts{"first", "second", "third", "fourth"}));
  EXPECT_EQ(file->index({1}).front().log_time_ns, 5000000010);
  EXPECT_EQ(file->warning(), "");
}

TEST_F(Ros1BagTest, BagsThatWereNotClosedNameTheRemedy) {
  expectThrows<Error>([&] { open(writer_.bytes(false)); }, {"file.bag", "not indexed", "rosbag reindex"});
}

TEST_F(Ros1BagTest, CutAtAnyByteIsAnErrorThatNamesTheRemedy) {
  const std::string bytes = writer_.bytes();
  for (std::size_t size = 256; size < bytes.size(); ++size) {
    expectThrows<Error>([&] { open(bytes.substr(0, size)); }, {"rosbag reindex"});
  }
  for (std::size_t size = 0; size < 256; ++size) EXPECT_THROW(open(bytes.substr(0, size)), Error) << size;
}

TEST_F(Ros1BagTest, AnyDamagedByteNeverCrashes) {
  const std::string bytes = writer_.bytes();
  for (std::size_t at = 0; at < bytes.size(); ++at) {
    for (const char value : {'\x05', '\xFF'}) {
      std::string damaged = bytes;
      damaged[at] = value;
      try {
        textsOf(*open(damaged));
      } catch (const Error&) {
      }
    }
  }
}

TEST_F(Ros1BagTest, ADamagedMessageLeavesTheOthersReadable) {
  std::string bytes = writer_.bytes();
  const std::size_t at = bytes.find("first") - 4;
  bytes.replace(at, 4, "\xFF\xFF\xFF\x7F");
  const auto file = open(bytes);
  EXPECT_EQ(textsOf(*file), (Texts{"damaged", "second", "third", "fourth"}));
  expectThrows<Error>([&] { file->read(file->index({1}).front()); }, {"file.bag: offset 256", "cut short"});
}

TEST_F(Ros1BagTest, ADamagedChunkIsLeftOutWithAWarning) {
  std::string bytes = writer_.bytes();
  bytes.replace(bytes.find("compression="), 4, "\x7F\x7F\x7F\x7F");
  bytes[256] = '\x7F';
  bytes[259] = '\x7F';
  const auto file = open(bytes);
  EXPECT_EQ(textsOf(*file), (Texts{"second", "fourth"}));
  EXPECT_NE(file->warning().find("1 of its 2 chunks are damaged"), std::string::npos);
}

}  // namespace
}  // namespace saw_ndt::internal
