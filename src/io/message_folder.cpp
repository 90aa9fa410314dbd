#include "io/message_folder.h"

#include <algorithm>

#include "io/natural_order.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

bool isMessageFileName(const fs::path& path) { return path.extension() == ".db3" || path.extension() == ".mcap"; }
bool isCompressedName(const fs::path& path) {
  return path.extension() == ".zstd" && isMessageFileName(fs::path(path).replace_extension());
}

class MessageFolder : public MessageFile {
 public:
  explicit MessageFolder(const fs::path& folder) : MessageFile(folder) {
    std::vector<fs::path> paths;
    for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
      if (isCompressedName(entry.path())) {
        throw Error(entry.path().string(), "",
                    "the file is compressed as a whole: unpack it with `unzstd " + entry.path().string() + "`");
      }
      if (isMessageFileName(entry.path())) paths.push_back(entry.path());
    }
    std::sort(paths.begin(), paths.end(), [](const fs::path& a, const fs::path& b) {
      return naturallyBefore(a.filename().string(), b.filename().string());
    });
    if (paths.empty()) throw Error(folder.string(), "", "holds no .db3 and no .mcap file");
    for (const fs::path& path : paths) add(path, paths.size() == 1);
    if (files_.empty()) throw Error(folder.string(), "", "none of its files can be read: " + warning());
  }

 protected:
  std::string placeOf(const MessageEntry&) const override { return ""; }

  void collect(const std::vector<bool>& wanted, std::vector<MessageEntry>& entries) override {
    for (std::size_t file = 0; file < files_.size(); ++file) {
      std::vector<std::uint32_t> topics;
      for (std::uint32_t topic = 0; topic < topics_of_files_[file].size(); ++topic) {
        if (wanted[topics_of_files_[file][topic]]) topics.push_back(topic);
      }
      for (MessageEntry& entry : files_[file]->index(topics)) {
        entry.topic = topics_of_files_[file][entry.topic];
        entry.file = static_cast<std::uint32_t>(file);
        entries.push_back(entry);
      }
    }
  }

  ByteView readMessage(const MessageEntry& entry) override { return files_[entry.file]->read(ownEntry(entry)); }
  ByteView readStart(const MessageEntry& entry, std::size_t bytes) override {
    return files_[entry.file]->readHead(ownEntry(entry), bytes);
  }

 private:
  void add(const fs::path& path, bool only) {
    std::unique_ptr<MessageFile> file;
    try {
      file = openMessageFile(path);
    } catch (const Error& error) {
      if (only) throw;
      warn(error.what());
      return;
    }
    if (!file->warning().empty()) warn(path.filename().string() + ": " + file->warning());
    std::vector<std::uint32_t> topics;
    for (const MessageTopic& topic : file->topics()) {
      topics.push_back(topicOf(topic.name, topic.type, topic.encoding));
      topics_[topics.back()].messages += topic.messages;
    }
    files_.push_back(std::move(file));
    topics_of_files_.push_back(std::move(topics));
  }

  /// As the file has it.
  MessageEntry ownEntry(MessageEntry entry) const {
    const std::vector<std::uint32_t>& topics = topics_of_files_[entry.file];
    entry.topic = static_cast<std::uint32_t>(std::find(topics.begin(), topics.end(), entry.topic) - topics.begin());
    return entry;
  }

  std::vector<std::unique_ptr<MessageFile>> files_;
  std::vector<std::vector<std::uint32_t>> topics_of_files_;  // what is here the topic of a file
};

}  // namespace

bool isMessageFolder(const fs::path& folder) {
  std::error_code error;
  if (fs::exists(folder / "metadata.yaml", error)) return true;
  return std::any_of(fs::directory_iterator(folder, error), fs::directory_iterator(),
                     [](const fs::directory_entry& entry) {
                       return isMessageFileName(entry.path()) || isCompressedName(entry.path());
                     });
}

std::unique_ptr<MessageFile> openMessageFolder(const fs::path& folder) {
  return std::make_unique<MessageFolder>(folder);
}

}  // namespace saw_ndt::internal
