#include <gtest/gtest.h>

#include <algorithm>

#include "expect_throws.h"
#include "io/mcap_bytes.h"
#include "io/mcap_records.h"
#include "io/message_file.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

const std::string kChannels = McapWriter::channel(1, "/points", "sensor_msgs/msg/PointCloud2") +
                              McapWriter::channel(2, "/odom", "nav_msgs/msg/Odometry") +
                              McapWriter::channel(3, "/json", "any", "json");

std::string textOf(ByteView bytes) { return std::string(reinterpret_cast<const char*>(bytes.data), bytes.size); }

class McapFileTest : public ::testing::Test {
 protected:
  std::unique_ptr<MessageFile> open(const std::string& bytes) const {
    return openMessageFile(folder_.write("file.mcap", bytes));
  }
  /// What the messages of all topics say, in order; those that cannot be read as "damaged".
  std::vector<std::string> textsOf(MessageFile& file) const {
    std::vector<std::uint32_t> topics;
    for (std::uint32_t i = 0; i < file.topics().size(); ++i) topics.push_back(i);
    std::vector<std::string> texts;
    for (const MessageEntry& entry : file.index(topics)) {
      try {
        texts.push_back(textOf(file.read(entry)));
        EXPECT_EQ(textOf(file.readHead(entry, 2)).substr(0, 2), texts.back().substr(0, 2));
      } catch (const Error&) {
        texts.push_back("damaged");
      }
    }
    return texts;
  }
  static McapWriter twoChunks() {
    McapWriter writer;
    writer.addChunk(kChannels, {{1, 30, "third"}, {2, 10, "first"}});
    return writer.addChunk("", {{1, 40, "fourth"}, {3, 20, "second"}});
  }

  TemporaryFolder folder_;
};

using Texts = std::vector<std::string>;

TEST_F(McapFileTest, TopicsHaveTheirTypesEncodingsAndCounts) {
  const auto file = open(twoChunks().whole(kChannels));
  ASSERT_EQ(file->topics().size(), 3U);
  EXPECT_EQ(file->topics()[0].name, "/points");
  EXPECT_EQ(file->topics()[0].type, "sensor_msgs/PointCloud2");
  EXPECT_EQ(file->topics()[0].encoding, MessageEncoding::CDR);
  EXPECT_EQ(file->topics()[0].messages, 2U);
  EXPECT_EQ(file->topics()[2].encoding, MessageEncoding::OTHER);
  EXPECT_EQ(file->warning(), "");
}

TEST_F(McapFileTest, MessagesAreInTheOrderOfTheirTimes) {
  const auto file = open(twoChunks().whole(kChannels));
  EXPECT_EQ(textsOf(*file), (Texts{"first", "second", "third", "fourth"}));
  const std::vector<MessageEntry> points = file->index({0});
  ASSERT_EQ(points.size(), 2U);
  EXPECT_EQ(points[1].log_time_ns, 40);
}

TEST_F(McapFileTest, WithoutSummaryChannelsAreFoundInTheChunks) {
  const auto file = open(twoChunks().withoutSummary());
  EXPECT_EQ(textsOf(*file), (Texts{"first", "second", "third", "fourth"}));
  EXPECT_NE(file->warning().find("cut short"), std::string::npos);
}

TEST_F(McapFileTest, WithoutIndexAndWithoutChunksMessagesAreFound) {
  McapWriter writer;
  writer.addChunk(kChannels, {{1, 20, "b"}}, false).addRecords(McapWriter::message({2, 10, "a"}));
  EXPECT_EQ(textsOf(*open(writer.whole(""))), (Texts{"a", "b"}));
}

TEST_F(McapFileTest, OfAChunkThatIsCutTheFirstMessagesAreRead) {
  McapWriter writer;
  writer.addChunk(kChannels, {{1, 10, "a"}, {1, 20, "b"}}, false);
  const std::string bytes = writer.withoutSummary();
  EXPECT_EQ(textsOf(*open(bytes.substr(0, bytes.size() - 1))), Texts{"a"});
}

TEST_F(McapFileTest, CutAtAnyByteGivesTheMessagesBefore) {
  const std::string bytes = twoChunks().whole(kChannels);
  std::size_t most = 0;
  for (std::size_t size = 0; size < bytes.size() - kMcapMagicBytes; ++size) {
    try {
      const auto file = open(bytes.substr(0, size));
      const Texts texts = textsOf(*file);
      EXPECT_EQ(std::count(texts.begin(), texts.end(), "damaged"), 0) << size;
      EXPECT_GE(texts.size(), most) << size;
      EXPECT_FALSE(file->warning().empty());
      most = texts.size();
    } catch (const Error&) {
      EXPECT_EQ(most, 0U) << size;
    }
  }
  EXPECT_EQ(most, 4U);
}

TEST_F(McapFileTest, AnyDamagedByteNeverCrashes) {
  const std::string bytes = twoChunks().whole(kChannels);
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

TEST_F(McapFileTest, WrongChecksumDamagesTheMessagesOfItsChunkAlone) {
  McapWriter writer;
  writer.addChunk(kChannels, {{1, 10, "a"}}, true, 12345).addChunk("", {{1, 20, "b"}});
  const auto file = open(writer.whole(kChannels));
  EXPECT_EQ(textsOf(*file), (Texts{"damaged", "b"}));
  expectThrows<Error>([&] { file->read(file->index({0}).front()); }, {"file.mcap", "chunk at offset", "checksum"});
}

TEST_F(McapFileTest, AbsurdSizesTakeNoMemory) {
  const std::string absurd = bytesOf(std::uint64_t{1} << 62);
  const std::string head = bytesOf(std::uint64_t{0}) + bytesOf(std::uint64_t{0});
  const std::string none = bytesOf(std::uint32_t{0});
  McapWriter writer;
  writer.addRecords(kChannels);
  writer.add(6, head + absurd + none + sized("zstd") + bytesOf(std::uint64_t{3}) + "abc");
  writer.add(6, head + bytesOf(std::uint64_t{3}) + none + sized("zstd") + absurd + "abc");
  writer.add(6, head + bytesOf(std::uint64_t{1} << 30) + none + sized("lz4") + bytesOf(std::uint64_t{3}) + "abc");
  writer.add(7, bytesOf(std::uint16_t{1}) + bytesOf(std::uint32_t{0xFFFFFFF0}));
  writer.addChunk("", {{1, 20, "b"}});
  writer.addRecords(bytesOf(std::uint8_t{5}) + absurd);
  EXPECT_EQ(textsOf(*open(writer.withoutSummary())), Texts{"b"});
}

TEST_F(McapFileTest, BehindADamagedRecordTheNextChunkIsFoundByTheSummary) {
  McapWriter writer;
  writer.addRecords(kChannels).addChunk("", {{1, 10, "a"}});
  writer.addRecords(bytesOf(std::uint8_t{9}) + bytesOf(std::uint64_t{1} << 40) + "lost");
  writer.addChunk("", {{1, 20, "b"}});
  const auto file = open(writer.whole(kChannels));
  EXPECT_EQ(textsOf(*file), (Texts{"a", "b"}));
  EXPECT_NE(file->warning().find("damaged at 1 of"), std::string::npos);
}

TEST_F(McapFileTest, FolderOfFilesIsOneRecordingInNaturalOrder) {
  for (int part = 8; part < 12; ++part) {
    McapWriter writer;
    writer.addChunk(kChannels, {{1, 5, "part " + std::to_string(part)}});
    folder_.write("bag/part_" + std::to_string(part) + ".mcap", writer.whole(kChannels));
  }
  ASSERT_TRUE(isBag(folder_.path() / "bag"));
  const auto file = openMessageFile(folder_.path() / "bag");
  EXPECT_EQ(file->topics()[0].messages, 4U);
  EXPECT_EQ(textsOf(*file), (Texts{"part 8", "part 9", "part 10", "part 11"}));
  folder_.write("bag/part_12.mcap.zstd", "");
  expectThrows<Error>([&] { openMessageFile(folder_.path() / "bag"); }, {"part_12.mcap.zstd", "unzstd"});
}

TEST_F(McapFileTest, OtherFilesAndFoldersAreNoBags) {
  EXPECT_TRUE(isBag(folder_.write("a", twoChunks().whole(kChannels))));
  EXPECT_FALSE(isBag(folder_.write("b.mcap", "no mcap")));
  EXPECT_FALSE(isBag(folder_.write("c.bag", "")));
  EXPECT_FALSE(isBag(folder_.path() / "missing.bag"));
  folder_.write("empty/file", "");
  EXPECT_FALSE(isBag(folder_.path() / "empty"));
  folder_.write("empty/metadata.yaml", "");
  EXPECT_TRUE(isBag(folder_.path() / "empty"));
  expectThrows<Error>([&] { openMessageFile(folder_.path() / "empty"); }, {"holds no .db3 and no .mcap file"});
}

}  // namespace
}  // namespace saw_ndt::internal
