#include "io/ros1_bag.h"

#include <algorithm>
#include <map>

#include "io/decompression.h"
#include "io/random_access_file.h"
#include "io/stamp_seconds.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr char kRemedy[] = "; `rosbag reindex` mends it";

// The kinds of records.
constexpr char kMessage = 2, kBagHeader = 3, kIndexData = 4, kChunk = 5, kChunkInfo = 6, kConnection = 7;

/// The named values in front of a record's data.
class Fields {
 public:
  explicit Fields(ByteView bytes) {
    ByteReader reader(bytes);
    while (reader.remaining() > 0) {
      const std::string field = reader.readString();
      const std::size_t equals = field.find('=');
      if (equals == std::string::npos) throw DamagedData("the head of a record is damaged");
      values_.emplace(field.substr(0, equals), field.substr(equals + 1));
    }
  }

  /// Empty where there is none.
  const std::string& text(const std::string& name) const {
    static const std::string nothing;
    const auto value = values_.find(name);
    return value == values_.end() ? nothing : value->second;
  }

  template <typename Number>
  Number number(const std::string& name) const {
    const std::string& bytes = text(name);
    if (bytes.size() != sizeof(Number)) throw DamagedData("the head of a record has no " + name);
    Number result;
    std::memcpy(&result, bytes.data(), sizeof(Number));
    return result;
  }

  char kind() const { return number<char>("op"); }

 private:
  std::map<std::string, std::string> values_;
};

struct Record {
  Fields fields;
  std::uint64_t data = 0;       // offset in the file
  std::uint64_t data_size = 0;  // within the file
};

class Ros1Bag : public MessageFile {
 public:
  explicit Ros1Bag(const std::filesystem::path& path) : MessageFile(path), file_(path) {
    std::uint64_t index_place = 0;
    std::uint32_t chunk_count = 0;
    try {
      const ByteView magic = file_.read(0, kMagic.size());
      if (std::string_view(reinterpret_cast<const char*>(magic.data), magic.size) != kMagic) {
        throw Error(path.string(), "", std::string("only version 2.0 of bags of ROS 1 is read") + kRemedy);
      }
      const Record head = recordAt(kMagic.size());
      if (head.fields.kind() != kBagHeader) throw DamagedData("the head of the bag is missing");
      if (!head.fields.text("encryptor").empty()) throw DamagedData("the bag is encrypted");
      index_place = head.fields.number<std::uint64_t>("index_pos");
      chunk_count = head.fields.number<std::uint32_t>("chunk_count");
    } catch (const DamagedData& damage) {
      throw Error(path.string(), "", damage.what());
    }
    if (index_place == 0) throw Error(path.string(), "", std::string("the bag is not indexed") + kRemedy);
    if (index_place > file_.size()) throw Error(path.string(), "", std::string("the bag is cut short") + kRemedy);
    readIndex(index_place, chunk_count);
  }

 protected:
  std::string placeOf(const MessageEntry& entry) const override {
    return "offset " + std::to_string(chunks_[entry.chunk].place) + ", " + std::to_string(entry.place) +
           " in this chunk";
  }

  void collect(const std::vector<bool>& wanted, std::vector<MessageEntry>& entries) override {
    for (const IndexRecord& record : index_) {
      const std::uint32_t topic = topics_of_connections_.at(record.connection);
      if (!wanted[topic]) continue;
      ByteReader reader(file_.read(record.place, std::uint64_t{record.count} * kIndexEntryBytes));
      for (std::uint32_t i = 0; i < record.count; ++i) {
        MessageEntry entry;
        entry.topic = topic;
        entry.chunk = record.chunk;
        const auto seconds = reader.read<std::uint32_t>();
        entry.log_time_ns = nanoseconds(seconds, reader.read<std::uint32_t>());
        entry.place = reader.read<std::uint32_t>();
        entries.push_back(entry);
      }
    }
  }

  ByteView readMessage(const MessageEntry& entry) override {
    const Chunk& chunk = chunks_[entry.chunk];
    if (chunk.compression != "none") return messageIn(unpacked(chunk), entry);
    const Span message = messageAt(chunk, entry);
    return file_.read(message.place, message.size);
  }

  ByteView readStart(const MessageEntry& entry, std::size_t bytes) override {
    const Chunk& chunk = chunks_[entry.chunk];
    if (chunk.compression != "none") return messageIn(unpacked(chunk), entry);
    const Span message = messageAt(chunk, entry);
    return file_.read(message.place, std::min<std::uint64_t>(message.size, bytes));
  }

 private:
  static constexpr std::uint64_t kIndexEntryBytes = 12;

  struct Chunk {
    std::uint64_t place, data, size, unpacked_size;
    std::string compression;
  };
  struct IndexRecord {
    std::size_t chunk;
    std::uint32_t connection;
    std::uint64_t place;
    std::uint32_t count;
  };
  struct Span {
    std::uint64_t place, size;
  };

  /// A record that lies in the first `end` bytes of the file.
  Record recordAt(std::uint64_t place, std::uint64_t end) {
    if (place > end || end - place < 4) throw DamagedData("a record is cut short");
    const auto head_size = ByteReader(file_.read(place, 4)).read<std::uint32_t>();
    if (end - place < std::uint64_t{8} + head_size) throw DamagedData("the head of a record is cut short");
    Record record{Fields(file_.read(place + 4, head_size))};
    record.data = place + 8 + head_size;
    record.data_size = ByteReader(file_.read(record.data - 4, 4)).read<std::uint32_t>();
    if (record.data_size > end - record.data) throw DamagedData("a record is cut short");
    return record;
  }
  Record recordAt(std::uint64_t place) { return recordAt(place, file_.size()); }

  /// The connections and chunks, which stand at the end of the file.
  void readIndex(std::uint64_t place, std::uint32_t chunk_count) {
    std::vector<std::uint64_t> chunk_places;
    try {
      while (place < file_.size()) {
        const Record record = recordAt(place);
        if (record.fields.kind() == kConnection) addConnection(record);
        if (record.fields.kind() == kChunkInfo) {
          chunk_places.push_back(record.fields.number<std::uint64_t>("chunk_pos"));
        }
        place = record.data + record.data_size;
      }
    } catch (const DamagedData& damage) {
      throw Error(path().string(), "offset " + std::to_string(place), std::string(damage.what()) + kRemedy);
    }
    if (chunk_places.size() < chunk_count) {
      throw Error(path().string(), "", std::string("the bag is cut short") + kRemedy);
    }
    std::size_t damaged = 0;
    for (const std::uint64_t chunk_place : chunk_places) {
      try {
        addChunk(chunk_place);
      } catch (const DamagedData&) {
        ++damaged;
      }
    }
    if (damaged > 0) {
      warn(std::to_string(damaged) + " of its " + std::to_string(chunk_places.size()) +
           " chunks are damaged, whose messages are left out");
    }
  }

  void addConnection(const Record& record) {
    const auto connection = record.fields.number<std::uint32_t>("conn");
    const Fields data(file_.read(record.data, record.data_size));
    topics_of_connections_[connection] = topicOf(record.fields.text("topic"), data.text("type"), MessageEncoding::ROS1);
  }

  void addChunk(std::uint64_t place) {
    const Record record = recordAt(place);
    if (record.fields.kind() != kChunk) throw DamagedData("a chunk is missing");
    chunks_.push_back({place, record.data, record.data_size, record.fields.number<std::uint32_t>("size"),
                       record.fields.text("compression")});
    // An index for each of its connections follows.
    place = record.data + record.data_size;
    while (place < file_.size()) {
      const Record index = recordAt(place);
      if (index.fields.kind() != kIndexData) return;
      place = index.data + index.data_size;
      IndexRecord entry{chunks_.size() - 1, index.fields.number<std::uint32_t>("conn"), index.data,
                        index.fields.number<std::uint32_t>("count")};
      const auto topic = topics_of_connections_.find(entry.connection);
      if (topic == topics_of_connections_.end() || index.data_size / kIndexEntryBytes < entry.count) {
        throw DamagedData("the index of a chunk is damaged");
      }
      topics_[topic->second].messages += entry.count;
      index_.push_back(entry);
    }
  }

  ByteView unpacked(const Chunk& chunk) {
    return cache_.get(chunk.place, [&](std::vector<unsigned char>& bytes) {
      requireUnpackedSize(chunk.unpacked_size);
      const ByteView packed = file_.read(chunk.data, chunk.size);
      if (chunk.compression == "lz4") {
        decompressLz4(packed, chunk.unpacked_size, bytes);
      } else if (chunk.compression == "bz2") {
        decompressBz2(packed, chunk.unpacked_size, bytes);
      } else {
        throw DamagedData("the compression '" + chunk.compression.substr(0, 20) + "' is not known");
      }
      requireAllUnpacked(bytes.size(), chunk.unpacked_size);
    });
  }

  void requireMessage(const Fields& fields, const MessageEntry& entry) const {
    if (fields.kind() == kMessage) {
      const auto topic = topics_of_connections_.find(fields.number<std::uint32_t>("conn"));
      if (topic != topics_of_connections_.end() && topic->second == entry.topic) return;
    }
    throw DamagedData("there is no message of its topic");
  }

  ByteView messageIn(ByteView chunk, const MessageEntry& entry) const {
    ByteReader reader(chunk);
    reader.bytes(entry.place);
    requireMessage(Fields(reader.bytes(reader.read<std::uint32_t>())), entry);
    return reader.bytes(reader.read<std::uint32_t>());
  }

  /// The same in a chunk that is not compressed, where the rest of it need not be read.
  Span messageAt(const Chunk& chunk, const MessageEntry& entry) {
    const Record record = recordAt(chunk.data + entry.place, chunk.data + chunk.size);
    requireMessage(record.fields, entry);
    return {record.data, record.data_size};
  }

  RandomAccessFile file_;
  std::map<std::uint32_t, std::uint32_t> topics_of_connections_;
  std::vector<Chunk> chunks_;
  std::vector<IndexRecord> index_;
  ChunkCache cache_;
};

}  // namespace

std::unique_ptr<MessageFile> openRos1Bag(const std::filesystem::path& path) { return std::make_unique<Ros1Bag>(path); }

}  // namespace saw_ndt::internal
