#pragma once

#include <filesystem>

namespace stillkite {

/// A new file beside the one that it will become, NAME.PID.part. It is this process's alone, which
/// holds a lock on it; what a killed one left under such a name is removed.
class PartFile {
 public:
  /// Throws InputError, which names the file and the reason.
  explicit PartFile(std::filesystem::path file);
  PartFile(PartFile&& other) noexcept;
  PartFile& operator=(PartFile&&) = delete;
  /// Removes it unless it has been renamed.
  ~PartFile();

  [[nodiscard]] const std::filesystem::path& file() const { return file_; }
  [[nodiscard]] const std::filesystem::path& path() const { return part_; }
  [[nodiscard]] int descriptor() const { return descriptor_; }

  /// The file gets its name. Throws std::runtime_error.
  void rename();

 private:
  std::filesystem::path file_;
  std::filesystem::path part_;
  int descriptor_ = -1;
};

/// Removes what killed processes left of the file. What one that lives is writing stays.
void remove_parts_left_of(const std::filesystem::path& file);

/// While it lives no other one of that folder does, in any process: results of two runs that end at
/// once do not mix. Where the file system has no locks it does nothing.
class FolderLock {
 public:
  explicit FolderLock(const std::filesystem::path& folder);
  FolderLock(const FolderLock&) = delete;
  FolderLock& operator=(const FolderLock&) = delete;
  ~FolderLock();

 private:
  int descriptor_;
};

}  // namespace stillkite
