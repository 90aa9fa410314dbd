#include "map/spilled_tiles.h"

#include <fcntl.h>
#include <stdlib.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstring>
#include <string>

#include "common/write_at.h"
#include "map/map_encoding.h"
#include "map/map_file_layout.h"
#include "saw_ndt/common/error.h"

namespace saw_ndt::internal {

/// The file, which nobody else can open and which goes with its last user.
class SpilledTiles::File {
 public:
  explicit File(const std::filesystem::path& folder) : folder_(folder.string()) {
    descriptor_ = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, 0600);
    if (descriptor_ >= 0) return;
    // Not every file system has files without a name.
    std::string name = (folder / ".saw_ndt_sums_XXXXXX").string();
    descriptor_ = mkostemp(name.data(), O_CLOEXEC);
    if (descriptor_ < 0) fail();
    unlink(name.c_str());
  }
  ~File() { close(descriptor_); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;

  // Returns where the bytes stand.
  std::uint64_t append(const std::vector<char>& bytes) {
    const std::uint64_t offset = end_.fetch_add(bytes.size());
    if (!writeAt(descriptor_, offset, bytes.data(), bytes.size())) fail();
    return offset;
  }
  void read(std::uint64_t offset, std::vector<char>& bytes) const {
    for (std::size_t done = 0; done < bytes.size();) {
      const ssize_t count =
          pread(descriptor_, bytes.data() + done, bytes.size() - done, static_cast<off_t>(offset + done));
      if (count < 0 && errno == EINTR) continue;
      if (count == 0) errno = EIO;
      if (count <= 0) fail();
      done += static_cast<std::size_t>(count);
    }
  }
  [[noreturn]] void fail() const { throw Error(folder_, "temporary file of sums", std::strerror(errno)); }

 private:
  std::string folder_;
  int descriptor_;
  std::atomic<std::uint64_t> end_{0};
};

SpilledTiles::SpilledTiles(const std::filesystem::path& folder)
    : file_(std::make_shared<File>(folder.empty() ? std::filesystem::path(".") : folder)) {}

void SpilledTiles::add(const std::vector<LabelledVoxelSums>& entries) {
  std::vector<char> bytes;
  MapTileRecord part = encodeTile(entries.data(), entries.data() + entries.size(), bytes);
  part.offset = file_->append(bytes);
  parts_.push_back(part);
}

void SpilledTiles::read(const MapTileRecord& part, std::vector<LabelledVoxelSums>& entries) const {
  std::vector<char> bytes(bytesOfEntries(part.entry_count));
  file_->read(part.offset, bytes);
  if (checksumOf(bytes.data(), bytes.size()) != part.checksum) {
    errno = EIO;
    file_->fail();
  }
  for (std::size_t i = 0; i < bytes.size(); i += sizeof(MapEntryLayout)) {
    MapEntryLayout layout;
    std::memcpy(&layout, bytes.data() + i, sizeof layout);
    entries.push_back(decodeEntry(layout, part.coordinate));
  }
}

}  // namespace saw_ndt::internal
