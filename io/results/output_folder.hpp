#pragma once

#include <cstdint>
#include <filesystem>

namespace stillkite {

/// A folder that appears under its name whole or not at all: filled beside it as NAME.part, renamed
/// by commit(), removed if that is never called.
class OutputFolder {
 public:
  /// Throws InputError if something other than an empty folder has the name, if there is a
  /// NAME.part, if nothing can be written there, and if the disk has less than `bytes` left.
  OutputFolder(const std::filesystem::path& folder, std::uintmax_t bytes);
  ~OutputFolder();
  OutputFolder(const OutputFolder&) = delete;
  OutputFolder& operator=(const OutputFolder&) = delete;

  /// Where to write until commit().
  [[nodiscard]] const std::filesystem::path& part() const { return part_; }
  void commit();

 private:
  std::filesystem::path folder_;
  std::filesystem::path part_;
  bool committed_ = false;
};

}  // namespace stillkite
