#pragma once

#include <cstdint>
#include <filesystem>

namespace stillkite {

/// Folder that appears under its name complete or not at all: filled as NAME.part, renamed by
/// commit(), else removed.
class OutputFolder {
 public:
  /// Throws InputError if the name exists and is not an empty folder, if NAME.part exists, if the
  /// folder is not writable, or has less than `bytes` of space.
  OutputFolder(const std::filesystem::path& folder, std::uintmax_t bytes);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// As the constructor, for a name that exists; before a long calculation.
  static void reject_existing(const std::filesystem::path& folder);

  /// Folder to write to until commit().
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }
  void commit();

 private:
  std::filesystem::path folder_;
  std::filesystem::path part_;
  bool committed_ = false;
};

}  // namespace stillkite
