#include <gtest/gtest.h>
#include <sqlite3.h>
#include <zstd.h>

#include "expect_throws.h"
#include "io/message_bytes.h"
#include "io/message_file.h"
#include "saw_ndt/common/error.h"
#include "temporary_folder.h"

namespace saw_ndt::internal {
namespace {

class Rosbag2DatabaseTest : public ::testing::Test {
 protected:
  void SetUp() override {
    run("CREATE TABLE topics(id INTEGER PRIMARY KEY, name TEXT, type TEXT, serialization_format TEXT);"
        "CREATE TABLE messages(id INTEGER PRIMARY KEY, topic_id INTEGER, timestamp INTEGER, data BLOB);"
        "INSERT INTO topics VALUES(4, '/points', 'sensor_msgs/msg/PointCloud2', 'cdr');"
        "INSERT INTO topics VALUES(5, '/tf', 'tf2_msgs/msg/TFMessage', 'cdr');"
        "INSERT INTO messages(topic_id, timestamp, data) VALUES(4, 30, CAST('third' AS BLOB));"
        "INSERT INTO messages(topic_id, timestamp, data) VALUES(5, 10, CAST('first' AS BLOB));"
        "INSERT INTO messages(topic_id, timestamp, data) VALUES(4, 20, CAST('second' AS BLOB));"
        "INSERT INTO messages(topic_id, timestamp, data) VALUES(7, 20, CAST('of no topic' AS BLOB));");
  }
  void run(const std::string& statements) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(path_.c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, statements.c_str(), nullptr, nullptr, nullptr), SQLITE_OK);
    sqlite3_close(database);
  }
  static std::vector<std::string> textsOf(MessageFile& file) {
    std::vector<std::string> texts;
    for (const MessageEntry& entry : file.index({0, 1})) {
      const ByteView bytes = file.read(entry);
      texts.emplace_back(reinterpret_cast<const char*>(bytes.data), bytes.size);
      EXPECT_EQ(file.readHead(entry, 3).size, 3U);
    }
    return texts;
  }

  TemporaryFolder folder_;
  std::filesystem::path path_ = folder_.path() / "50% ? #1.db3";
};

using Texts = std::vector<std::string>;

TEST_F(Rosbag2DatabaseTest, TopicsAndMessagesAreThoseOfTheFile) {
  const auto file = openMessageFile(path_);
  ASSERT_EQ(file->topics().size(), 2U);
  EXPECT_EQ(file->topics()[0].type, "sensor_msgs/PointCloud2");
  EXPECT_EQ(file->topics()[0].encoding, MessageEncoding::CDR);
  EXPECT_EQ(file->topics()[0].messages, 2U);
  EXPECT_EQ(textsOf(*file), (Texts{"first", "second", "third"}));
  EXPECT_EQ(file->warning(), "");
}

TEST_F(Rosbag2DatabaseTest, NothingIsWrittenBesideIt) {
  run("PRAGMA journal_mode = WAL");
  const std::size_t before = folder_.entryCount();
  const auto file = openMessageFile(path_);
  EXPECT_EQ(textsOf(*file).size(), 3U);
  EXPECT_EQ(folder_.entryCount(), before);
}

TEST_F(Rosbag2DatabaseTest, WhatWasNotYetWrittenIsTold) {
  folder_.write(path_.filename().string() + "-wal", "something");
  EXPECT_NE(openMessageFile(path_)->warning().find("-wal"), std::string::npos);
}

TEST_F(Rosbag2DatabaseTest, CompressedMessagesAreUnpacked) {
  const std::string text(100000, 'a');
  std::string packed(ZSTD_compressBound(text.size()), '\0');
  packed.resize(ZSTD_compress(packed.data(), packed.size(), text.data(), text.size(), 1));
  std::string digits;
  for (const char letter : packed) {
    for (const int digit : {(letter >> 4) & 15, letter & 15}) digits += "0123456789ABCDEF"[digit];
  }
  run("INSERT INTO messages(topic_id, timestamp, data) VALUES(5, 40, x'" + digits + "')");
  const auto file = openMessageFile(path_);
  EXPECT_EQ(textsOf(*file).back(), text);
}

TEST_F(Rosbag2DatabaseTest, AMessageThatIsNoBlobLeavesTheOthersReadable) {
  run("UPDATE messages SET data = NULL WHERE id = 2");
  const auto file = openMessageFile(path_);
  const std::vector<MessageEntry> entries = file->index({0, 1});
  ASSERT_EQ(entries.size(), 3U);
  expectThrows<Error>([&] { file->read(entries[0]); }, {"message of id 2"});
  EXPECT_EQ(file->read(entries[2]).size, 5U);
}

TEST_F(Rosbag2DatabaseTest, ViewsAndOtherDatabasesAreRefused) {
  run("ALTER TABLE messages RENAME TO m; CREATE VIEW messages AS SELECT * FROM m");
  expectThrows<Error>([&] { openMessageFile(path_); }, {"SQLite cannot read it"});
  run("DROP VIEW messages");
  expectThrows<Error>([&] { openMessageFile(path_); }, {"SQLite cannot read it", "messages"});
}

TEST_F(Rosbag2DatabaseTest, DamagedBytesNeverCrash) {
  std::ifstream stream(path_, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(stream)), std::istreambuf_iterator<char>());
  for (std::size_t at = 0; at < bytes.size(); at += bytes[at] == '\0' ? 37 : 1) {
    std::string damaged = bytes;
    damaged[at] = '\x7F';
    folder_.write("damaged.db3", damaged);
    try {
      const auto file = openMessageFile(folder_.path() / "damaged.db3");
      textsOf(*file);
    } catch (const std::exception&) {
    }
  }
  for (std::size_t size = 0; size < bytes.size(); size += 512) {
    folder_.write("cut.db3", bytes.substr(0, size));
    try {
      textsOf(*openMessageFile(folder_.path() / "cut.db3"));
    } catch (const std::exception&) {
    }
  }
}

}  // namespace
}  // namespace saw_ndt::internal
