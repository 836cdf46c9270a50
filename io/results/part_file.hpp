#pragma once

#include <filesystem>

namespace stillkite {

/// Temporary file NAME.PID.part next to its final name, locked by this process. Stale ones of
/// killed processes are removed.
class PartFile {
 public:
  /// Throws InputError with file and reason.
  explicit PartFile(std::filesystem::path file);
  PartFile(PartFile&& other) noexcept;
  PartFile& operator=(PartFile&&) = delete;
  /// Removes the file unless renamed.
  ~PartFile();

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const std::filesystem::path& path() const { return part_; }
  [[nodiscard]] int descriptor() const { return descriptor_; }

  /// Renames the file to file(). Throws std::runtime_error.
  void rename();

 private:
  std::filesystem::path file_;
  std::filesystem::path part_;
  int descriptor_ = -1;
};

/// Removes the part files of killed processes; those of running processes are locked and stay.
void remove_stale_parts(const std::filesystem::path& file);

enum class WhenLocked { wait, reject, share };

/// Lock on a folder across processes, so that results of simultaneous runs do not mix. No
/// effect on file systems without locks.
class FolderLock {
 public:
  /// `reject`: throws InputError if another process has the lock. `share`: only if it does not
  /// share it.
  explicit FolderLock(const std::filesystem::path& folder,
                      WhenLocked when_locked = WhenLocked::wait);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int descriptor_;
};

}  // namespace stillkite
