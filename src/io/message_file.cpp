#include "io/message_file.h"

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <string_view>

#include "common/input_file.h"
#include "io/mcap_file.h"
#include "io/message_folder.h"
#include "io/ros1_bag.h"
#include "io/rosbag2_database.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

namespace fs = std::filesystem;

namespace {

enum class BagKind { NONE, ROS1, DATABASE, MCAP, FOLDER };

BagKind kindOfFile(const fs::path& path) {
  constexpr std::pair<std::string_view, BagKind> kMagics[] = {
      {std::string_view("#ROSBAG V", 9), BagKind::ROS1},
      {std::string_view("SQLite format 3\0", 16), BagKind::DATABASE},
      {std::string_view("\x89MCAP", 5), BagKind::MCAP},
  };
  std::array<char, 16> first{};
  std::ifstream stream = openInputFile(path);
  stream.read(first.data(), first.size());
  const std::string_view read(first.data(), static_cast<std::size_t>(stream.gcount()));
  for (const auto& [magic, kind] : kMagics) {
    if (read.substr(0, magic.size()) == magic) return kind;
  }
  return BagKind::NONE;
}

BagKind kindOf(const fs::path& path) {
  std::error_code ignored;
  if (!fs::is_directory(path, ignored)) return kindOfFile(path);
  return isMessageFolder(path) ? BagKind::FOLDER : BagKind::NONE;
}

[[noreturn, maybe_unused]] void refuse(const fs::path& path, const char* package) {
  throw Error(path.string(), "", std::string("cannot be read, since saw_ndt was built without ") + package);
}

/// As types of ROS 1 are written, which ROS 2 has a word more in.
std::string typeWithoutKind(const std::string& type) {
  constexpr std::string_view kKind = "/msg/";
  const std::size_t at = type.find(kKind);
  return at == std::string::npos ? type : type.substr(0, at) + "/" + type.substr(at + kKind.size());
}

}  // namespace

std::uint32_t MessageFile::topicOf(const std::string& name, const std::string& type, MessageEncoding encoding) {
  const std::string form = typeWithoutKind(type);
  const auto [known, added] = numbers_.try_emplace({name, form, encoding}, static_cast<std::uint32_t>(topics_.size()));
  if (added) topics_.push_back({name, form, encoding, 0});
  return known->second;
}

void MessageFile::warn(const std::string& what) {
  if (!warning_.empty()) warning_ += "; ";
  warning_ += what;
}

std::vector<MessageEntry> MessageFile::index(const std::vector<std::uint32_t>& topics) {
  std::vector<bool> wanted(topics_.size(), false);
  for (const std::uint32_t topic : topics) wanted.at(topic) = true;
  std::vector<MessageEntry> entries;
  collect(wanted, entries);
  std::stable_sort(entries.begin(), entries.end(),
                   [](const MessageEntry& a, const MessageEntry& b) { return a.log_time_ns < b.log_time_ns; });
  return entries;
}

ByteView MessageFile::read(const MessageEntry& entry) {
  try {
    return readMessage(entry);
  } catch (const DamagedData& damage) {
    throw Error(path_.string(), placeOf(entry), damage.what());
  }
}

ByteView MessageFile::readHead(const MessageEntry& entry, std::size_t bytes) {
  try {
    return readStart(entry, bytes);
  } catch (const DamagedData& damage) {
    throw Error(path_.string(), placeOf(entry), damage.what());
  }
}

bool isBag(const fs::path& path) {
  try {
    return kindOf(path) != BagKind::NONE;
  } catch (const Error&) {
    return false;
  }
}

std::unique_ptr<MessageFile> openMessageFile(const fs::path& path) {
  switch (kindOf(path)) {
    case BagKind::ROS1:
#if SAW_NDT_HAS_ROSBAG
      return openRos1Bag(path);
#else
      refuse(path, "libbz2-dev and liblz4-dev");
#endif
    case BagKind::DATABASE:
#if SAW_NDT_HAS_SQLITE
      return openRosbag2Database(path);
#else
      refuse(path, "libsqlite3-dev and libzstd-dev");
#endif
    case BagKind::MCAP:
#if SAW_NDT_HAS_MCAP
      return openMcap(path);
#else
      refuse(path, "libzstd-dev and liblz4-dev");
#endif
    case BagKind::FOLDER:
      return openMessageFolder(path);
    case BagKind::NONE:
      break;
  }
  throw Error(path.string(), "", "is no bag of ROS 1 or ROS 2");
}

}  // namespace saw_ndt::internal
