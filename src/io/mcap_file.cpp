#include "io/mcap_file.h"

#include <algorithm>
#include <limits>
#include <optional>
#include <set>

#include "io/mcap_records.h"
#include "io/random_access_file.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace {

// MessageEntry::chunk of a message that is in no chunk; its place is an offset in the file then.
constexpr std::uint64_t kNoChunk = std::numeric_limits<std::uint64_t>::max();

class McapFile : public MessageFile {
 public:
  explicit McapFile(const std::filesystem::path& path) : MessageFile(path), file_(path) {
    walk();
    for (std::size_t chunk = 0; chunk < chunks_.size(); ++chunk) {
      if (chunks_with_index_.count(chunk) == 0) scan(chunk, true);
    }
    if (damaged_chunks_ > 0) {
      warn(std::to_string(damaged_chunks_) + " chunks are damaged and have no index: they are left out");
    }
    if (damaged_places_ > 0) warn("the file is damaged at " + std::to_string(damaged_places_) + " of its records");
    if (damaged_records_ > 0) warn(std::to_string(damaged_records_) + " records are damaged and left out");
    learnChannels();
    makeTopics();
  }

 protected:
  std::string placeOf(const MessageEntry& entry) const override {
    if (entry.chunk == kNoChunk) return "offset " + std::to_string(entry.place);
    return "chunk at offset " + std::to_string(chunks_[entry.chunk].records);
  }

  void collect(const std::vector<bool>& wanted, std::vector<MessageEntry>& entries) override {
    for (const IndexRecord& record : index_) {
      const auto topic = topics_of_channels_.find(record.channel);
      if (topic == topics_of_channels_.end() || !wanted[topic->second]) continue;
      ByteReader reader(file_.read(record.place, record.count * kMcapIndexEntryBytes));
      for (std::uint64_t i = 0; i < record.count; ++i) {
        MessageEntry entry;
        entry.topic = topic->second;
        entry.chunk = record.chunk;
        entry.log_time_ns = reader.read<std::int64_t>();
        entry.place = reader.read<std::uint64_t>();
        entries.push_back(entry);
      }
    }
    for (const auto& [channel, listed] : listed_) {
      const auto topic = topics_of_channels_.find(channel);
      if (topic == topics_of_channels_.end() || !wanted[topic->second]) continue;
      for (MessageEntry entry : listed) {
        entry.topic = topic->second;
        entries.push_back(entry);
      }
    }
  }

  ByteView readMessage(const MessageEntry& entry) override {
    if (entry.chunk == kNoChunk) return messageInFile(entry, file_.size(), file_.size());
    const ByteView records = unpacked(entry.chunk);
    ByteReader reader(records);
    reader.bytes(entry.place);
    if (static_cast<McapKind>(reader.read<std::uint8_t>()) != McapKind::MESSAGE) {
      throw DamagedData("there is no message where it should be");
    }
    ByteReader message(reader.bytes(reader.read<std::uint64_t>()));
    requireTopic(readMcapMessageHead(message), entry);
    return message.bytes(message.remaining());
  }

  ByteView readStart(const MessageEntry& entry, std::size_t bytes) override {
    if (entry.chunk == kNoChunk) return messageInFile(entry, file_.size(), bytes);
    const McapChunk& chunk = chunks_[entry.chunk];
    if (chunk.compression != McapChunk::Compression::NONE) return readMessage(entry);
    MessageEntry in_file = entry;
    if (entry.place > chunk.size) throw DamagedData("there is no message where it should be");
    in_file.place = chunk.records + entry.place;
    return messageInFile(in_file, chunk.records + chunk.size, bytes);
  }

 private:
  struct IndexRecord {
    std::size_t chunk;
    std::uint16_t channel;
    std::uint64_t place, count;
  };

  /// Goes from record to record through the file and reads their heads alone.
  void walk() {
    std::uint64_t place = kMcapMagicBytes;
    bool ended = false;
    while (!ended && place < file_.size()) {
      const std::uint64_t size = takeRecord(place, ended);
      if (size > 0) {
        place += size;
        continue;
      }
      const std::uint64_t next = placeBehindDamage(place);
      if (next == file_.size()) break;
      ++damaged_places_;
      forgetLastIndex();
      place = next;
    }
    if (ended) return;
    forgetLastIndex();
    warn("the file is cut short or damaged at offset " + std::to_string(place) + " and read up to there");
  }

  /// @param ended  set where the record is the last one
  /// @return bytes of the record; 0 where it is damaged or the file ends within it
  std::uint64_t takeRecord(std::uint64_t place, bool& ended) {
    if (file_.size() - place < kMcapHeadBytes) return 0;
    ByteReader head(file_.read(place, kMcapHeadBytes));
    const auto kind = static_cast<McapKind>(head.read<std::uint8_t>());
    const auto size = head.read<std::uint64_t>();
    const std::uint64_t there = file_.size() - place - kMcapHeadBytes;
    if (static_cast<std::uint8_t>(kind) == 0 || (size > there && kind != McapKind::CHUNK)) return 0;
    try {
      take(kind, place + kMcapHeadBytes, std::min(size, there));
    } catch (const DamagedData&) {
      ++damaged_records_;
      // The indices that follow belong to it.
      if (kind == McapKind::CHUNK) chunks_.emplace_back();
    }
    if (size > there) return 0;
    // A chunk that ends within the file is not cut but damaged.
    if (kind == McapKind::CHUNK && chunks_.back().cut) chunks_.back() = McapChunk();
    ended = kind == McapKind::FOOTER;
    return kMcapHeadBytes + size;
  }

  /// Where the next chunk is, or the summary, as the summary tells; the end of the file where it is not there.
  std::uint64_t placeBehindDamage(std::uint64_t place) {
    if (!known_places_) {
      known_places_.emplace();
      try {
        readKnownPlaces(*known_places_);
      } catch (const DamagedData&) {
      }
      std::sort(known_places_->begin(), known_places_->end());
    }
    const auto next = std::upper_bound(known_places_->begin(), known_places_->end(), place);
    return next == known_places_->end() ? file_.size() : std::min(*next, file_.size());
  }

  /// Those of the chunks and the summary, by the summary. Throws DamagedData behind the last one that can be read.
  void readKnownPlaces(std::vector<std::uint64_t>& places) {
    constexpr std::uint64_t kEndBytes = kMcapHeadBytes + kMcapFooterBytes + kMcapMagicBytes;
    if (file_.size() < kEndBytes) return;
    const std::uint64_t end = file_.size() - kEndBytes;
    ByteReader footer(file_.read(end, kEndBytes));
    if (static_cast<McapKind>(footer.read<std::uint8_t>()) != McapKind::FOOTER) return;
    footer.read<std::uint64_t>();
    const auto summary = footer.read<std::uint64_t>();
    if (summary == 0 || summary > end) return;
    places.push_back(summary);
    forEachMcapRecord(file_.read(summary, end - summary), [&](McapKind kind, ByteView content, std::size_t) {
      if (kind != McapKind::CHUNK_INDEX) return;
      ByteReader reader(content);
      reader.bytes(2 * sizeof(std::uint64_t));  // from when to when
      places.push_back(reader.read<std::uint64_t>());
    });
  }

  /// Where the file is damaged behind a chunk, its indices may be missing, or its end.
  void forgetLastIndex() {
    if (chunks_.empty()) return;
    const std::size_t last = chunks_.size() - 1;
    while (!index_.empty() && index_.back().chunk == last) index_.pop_back();
    chunks_with_index_.erase(last);
  }

  void take(McapKind kind, std::uint64_t place, std::uint64_t size) {
    switch (kind) {
      case McapKind::SCHEMA:
      case McapKind::CHANNEL:
        channels_.add(kind, file_.read(place, size));
        break;
      case McapKind::MESSAGE: {
        ByteReader reader(file_.read(place, std::min(size, kMcapMessageHeadBytes)));
        list(readMcapMessageHead(reader), kNoChunk, place - kMcapHeadBytes);
        break;
      }
      case McapKind::CHUNK:
        chunks_.push_back(readMcapChunkHead(file_.read(place, std::min(size, kMcapGreatestChunkHead)), place, size));
        break;
      case McapKind::MESSAGE_INDEX: {
        ByteReader reader(file_.read(place, std::min(size, kMcapIndexHeadBytes)));
        const auto channel = reader.read<std::uint16_t>();
        const auto bytes = reader.read<std::uint32_t>();
        if (chunks_.empty() || bytes > size - kMcapIndexHeadBytes) throw DamagedData("the index is damaged");
        chunks_with_index_.insert(chunks_.size() - 1);
        index_.push_back({chunks_.size() - 1, channel, place + kMcapIndexHeadBytes, bytes / kMcapIndexEntryBytes});
        break;
      }
      default:
        break;
    }
  }

  void list(const McapMessageHead& head, std::uint64_t chunk, std::uint64_t place) {
    MessageEntry entry;
    entry.log_time_ns = head.log_time_ns;
    entry.chunk = chunk;
    entry.place = place;
    listed_[head.channel].push_back(entry);
  }

  /// Takes the channels of a chunk and, where its index is missing, its messages.
  void scan(std::size_t number, bool messages) {
    scanned_.insert(number);
    try {
      forEachMcapRecord(unpacked(number), [&](McapKind kind, ByteView content, std::size_t offset) {
        if (kind != McapKind::MESSAGE) return channels_.add(kind, content);
        ByteReader reader(content);
        const McapMessageHead head = readMcapMessageHead(reader);
        if (messages) list(head, number, offset);
      });
    } catch (const DamagedData&) {
      if (messages && !chunks_[number].cut) ++damaged_chunks_;
    }
  }

  /// Where there is no summary, channels stand in the chunks alone: in that of their first message, or one before it.
  void learnChannels() {
    for (const IndexRecord& record : index_) learnChannel(record.channel, record.chunk);
    for (const auto& [channel, listed] : listed_) learnChannel(channel, listed.front().chunk);
  }

  /// @param chunk  of the first message of the channel
  void learnChannel(std::uint16_t channel, std::uint64_t chunk) {
    if (channels_.know(channel) || !unknown_.insert(channel).second) return;
    const auto scanOnce = [&](std::size_t number) {
      if (scanned_.count(number) == 0) scan(number, false);
    };
    if (chunk != kNoChunk) scanOnce(chunk);
    const std::size_t before = std::min<std::uint64_t>(chunk, chunks_.size());
    for (; !channels_.know(channel) && learned_ < before; ++learned_) scanOnce(learned_);
  }

  void makeTopics() {
    for (const auto& [number, channel] : channels_.channels) {
      const auto type = channels_.types.find(channel.schema);
      topics_of_channels_[number] =
          topicOf(channel.topic, type == channels_.types.end() ? std::string() : type->second, channel.encoding);
    }
    for (const IndexRecord& record : index_) count(record.channel, record.count);
    for (const auto& [channel, listed] : listed_) count(channel, listed.size());
    if (topics_.empty() && !warning().empty()) throw Error(path().string(), "", warning());
  }

  void count(std::uint16_t channel, std::size_t messages) {
    const auto topic = topics_of_channels_.find(channel);
    if (topic != topics_of_channels_.end()) topics_[topic->second].messages += messages;
  }

  ByteView unpacked(std::size_t number) {
    return cache_.get(number, [&](std::vector<unsigned char>& bytes) {
      unpackMcapChunk(chunks_[number], file_.read(chunks_[number].records, chunks_[number].size), bytes);
    });
  }

  void requireTopic(const McapMessageHead& head, const MessageEntry& entry) const {
    const auto topic = topics_of_channels_.find(head.channel);
    if (topic != topics_of_channels_.end() && topic->second == entry.topic) return;
    throw DamagedData("there is no message of its topic where it should be");
  }

  /// The first bytes of a message that is not compressed.
  /// @param end    of the records that it is one of
  /// @param bytes  at most
  ByteView messageInFile(const MessageEntry& entry, std::uint64_t end, std::uint64_t bytes) {
    constexpr std::uint64_t kHeads = kMcapHeadBytes + kMcapMessageHeadBytes;
    if (entry.place > end || end - entry.place < kHeads) throw DamagedData("the message is cut short");
    ByteReader reader(file_.read(entry.place, kHeads));
    const auto kind = static_cast<McapKind>(reader.read<std::uint8_t>());
    const auto size = reader.read<std::uint64_t>();
    if (kind != McapKind::MESSAGE || size < kMcapMessageHeadBytes) {
      throw DamagedData("there is no message where it should be");
    }
    if (size > end - entry.place - kMcapHeadBytes) throw DamagedData("the message is cut short");
    requireTopic(readMcapMessageHead(reader), entry);
    return file_.read(entry.place + kHeads, std::min(size - kMcapMessageHeadBytes, bytes));
  }

  RandomAccessFile file_;
  std::vector<McapChunk> chunks_;
  std::vector<IndexRecord> index_;
  std::map<std::uint16_t, std::vector<MessageEntry>> listed_;  // of channels; messages that no index tells
  McapChannels channels_;
  std::map<std::uint16_t, std::uint32_t> topics_of_channels_;
  std::set<std::size_t> chunks_with_index_, scanned_;
  std::size_t damaged_places_ = 0, damaged_records_ = 0, damaged_chunks_ = 0;
  std::optional<std::vector<std::uint64_t>> known_places_;  // see placeBehindDamage()
  std::size_t learned_ = 0;          // chunks from the first on that were looked through for channels
  std::set<std::uint16_t> unknown_;  // channels that were looked for
  ChunkCache cache_;
};

}  // namespace

std::unique_ptr<MessageFile> openMcap(const std::filesystem::path& path) { return std::make_unique<McapFile>(path); }

}  // namespace saw_ndt::internal
