#include "io/rosbag2_database.h"

#include <sqlite3.h>

#include <algorithm>
#include <limits>
#include <map>

#include "common/input_file.h"
#include "io/decompression.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

struct CloseDatabase {
  void operator()(sqlite3* database) const { sqlite3_close_v2(database); }
};
struct FinishStatement {
  void operator()(sqlite3_stmt* statement) const { sqlite3_finalize(statement); }
};
struct CloseBlob {
  void operator()(sqlite3_blob* blob) const { sqlite3_blob_close(blob); }
};
using Database = std::unique_ptr<sqlite3, CloseDatabase>;
using Statement = std::unique_ptr<sqlite3_stmt, FinishStatement>;
using Blob = std::unique_ptr<sqlite3_blob, CloseBlob>;

/// The file as a URI that lets SQLite neither lock it nor write beside it.
std::string readOnlyUri(const fs::path& path) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  std::string uri = "file:";
  for (const char letter : fs::absolute(path).string()) {
    const auto code = static_cast<unsigned char>(letter);
    if (letter == '%' || letter == '?' || letter == '#') {
      uri += {'%', kDigits[code >> 4], kDigits[code & 15]};
    } else {
      uri += letter;
    }
  }
  return uri + "?mode=ro&immutable=1";
}

bool isZstd(ByteView bytes) {
  constexpr unsigned char kMagic[] = {0x28, 0xB5, 0x2F, 0xFD};
  return bytes.size >= sizeof(kMagic) && std::equal(kMagic, kMagic + sizeof(kMagic), bytes.data);
}

class Rosbag2Database : public MessageFile {
 public:
  explicit Rosbag2Database(const fs::path& path) : MessageFile(path) {
    requireRegularFile(path);
    sqlite3* database = nullptr;
    const int result =
        sqlite3_open_v2(readOnlyUri(path).c_str(), &database, SQLITE_OPEN_READONLY | SQLITE_OPEN_URI, nullptr);
    database_.reset(database);
    if (result != SQLITE_OK) fail();
    // A file may not run what it brings along, nor hold more than its size.
    sqlite3_db_config(database, SQLITE_DBCONFIG_DEFENSIVE, 1, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_TRUSTED_SCHEMA, 0, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_VIEW, 0, nullptr);
    sqlite3_db_config(database, SQLITE_DBCONFIG_ENABLE_TRIGGER, 0, nullptr);
    const std::uintmax_t size = fs::file_size(path);
    sqlite3_limit(database, SQLITE_LIMIT_LENGTH,
                  static_cast<int>(std::min<std::uintmax_t>(size, std::numeric_limits<int>::max())));
    for (const char* suffix : {"-wal", "-journal"}) {
      std::error_code ignored;
      const fs::path beside = path.string() + suffix;
      if (fs::exists(beside, ignored) && fs::file_size(beside, ignored) > 0) {
        warn("the recording was not closed: what " + beside.filename().string() + " holds is not read");
      }
    }
    readTopics();
    forEachMessage([&](std::uint32_t topic, std::int64_t, std::int64_t) { ++topics_[topic].messages; });
    if (!damage_.empty()) warn("the file is damaged (" + damage_ + ") and read as far as it can be");
  }

 protected:
  std::string placeOf(const MessageEntry& entry) const override {
    return "message of id " + std::to_string(static_cast<std::int64_t>(entry.place));
  }

  void collect(const std::vector<bool>& wanted, std::vector<MessageEntry>& entries) override {
    forEachMessage([&](std::uint32_t topic, std::int64_t row, std::int64_t log_time_ns) {
      if (!wanted[topic]) return;
      MessageEntry entry;
      entry.topic = topic;
      entry.log_time_ns = log_time_ns;
      entry.place = static_cast<std::uint64_t>(row);
      entries.push_back(entry);
    });
  }

  ByteView readMessage(const MessageEntry& entry) override { return readBytes(entry, std::numeric_limits<int>::max()); }

  ByteView readStart(const MessageEntry& entry, std::size_t bytes) override {
    constexpr std::size_t kGreatest = std::numeric_limits<int>::max();
    return readBytes(entry, static_cast<int>(std::min(bytes, kGreatest)));
  }

 private:
  [[noreturn]] void fail() const {
    throw Error(path().string(), "", std::string("SQLite cannot read it: ") + sqlite3_errmsg(database_.get()));
  }

  Statement prepared(const char* text) const {
    sqlite3_stmt* statement = nullptr;
    if (sqlite3_prepare_v2(database_.get(), text, -1, &statement, nullptr) != SQLITE_OK) fail();
    return Statement(statement);
  }

  static std::string textOf(const Statement& row, int column) {
    const unsigned char* text = sqlite3_column_text(row.get(), column);
    return text == nullptr ? std::string() : std::string(reinterpret_cast<const char*>(text));
  }

  void readTopics() {
    const Statement row = prepared("SELECT id, name, type, serialization_format FROM topics ORDER BY id");
    int result = SQLITE_ROW;
    while ((result = sqlite3_step(row.get())) == SQLITE_ROW) {
      const MessageEncoding encoding = textOf(row, 3) == "cdr" ? MessageEncoding::CDR : MessageEncoding::OTHER;
      topics_of_ids_[sqlite3_column_int64(row.get(), 0)] = topicOf(textOf(row, 1), textOf(row, 2), encoding);
    }
    if (result != SQLITE_DONE) fail();
  }

  /// Calls take(topic, row, log_time_ns) with every message as far as the file can be read: from its begin and, where
  /// that fails, from its end, too.
  template <typename Take>
  void forEachMessage(Take take) {
    bool any = false;
    std::int64_t last = 0;
    const auto takeRow = [&](const Statement& row, std::int64_t number) {
      const auto topic = topics_of_ids_.find(sqlite3_column_int64(row.get(), 1));
      if (topic != topics_of_ids_.end()) take(topic->second, number, sqlite3_column_int64(row.get(), 2));
    };
    const Statement row = prepared("SELECT rowid, topic_id, timestamp FROM messages ORDER BY rowid");
    int result = SQLITE_ROW;
    while ((result = sqlite3_step(row.get())) == SQLITE_ROW) {
      any = true;
      last = sqlite3_column_int64(row.get(), 0);
      takeRow(row, last);
    }
    if (result == SQLITE_DONE) return;
    damage_ = sqlite3_errmsg(database_.get());
    const Statement back = prepared("SELECT rowid, topic_id, timestamp FROM messages ORDER BY rowid DESC");
    while (sqlite3_step(back.get()) == SQLITE_ROW) {
      const std::int64_t number = sqlite3_column_int64(back.get(), 0);
      if (any && number <= last) break;
      takeRow(back, number);
    }
  }

  ByteView readBytes(const MessageEntry& entry, int greatest) {
    sqlite3_blob* opened = nullptr;
    const int result = sqlite3_blob_open(database_.get(), "main", "messages", "data",
                                         static_cast<sqlite3_int64>(entry.place), 0, &opened);
    const Blob blob(opened);
    if (result != SQLITE_OK) throw DamagedData(sqlite3_errmsg(database_.get()));
    const int size = sqlite3_blob_bytes(opened);
    const auto read = [&](int bytes) {
      bytes_.resize(static_cast<std::size_t>(bytes));
      if (sqlite3_blob_read(opened, bytes_.data(), bytes, 0) != SQLITE_OK) {
        throw DamagedData(sqlite3_errmsg(database_.get()));
      }
      return ByteView{bytes_.data(), bytes_.size()};
    };
    const ByteView bytes = read(std::min(size, greatest));
    if (!isZstd(bytes)) return bytes;
    decompressZstd(read(size), std::min(kGreatestUnpackedBytes, static_cast<std::uint64_t>(greatest)), unpacked_);
    return {unpacked_.data(), unpacked_.size()};
  }

  Database database_;
  std::map<std::int64_t, std::uint32_t> topics_of_ids_;
  std::string damage_;
  std::vector<unsigned char> bytes_, unpacked_;
};

}  // namespace

std::unique_ptr<MessageFile> openRosbag2Database(const fs::path& path) {
  return std::make_unique<Rosbag2Database>(path);
}

}  // namespace saw_ndt::internal
