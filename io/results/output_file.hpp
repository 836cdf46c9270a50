#pragma once

#include <cstdint>
#include <filesystem>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/results/part_file.hpp"

namespace stillkite {

/// File that appears under its name complete or not at all: a PartFile, renamed by commit(), else
/// removed. Throws InputError if it cannot be created and std::runtime_error on a write error, each
/// with file and reason.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path file);

  /// Appends text. On a full disk the file ends after a complete line and can still be committed.
  void write(std::string_view text);
  /// Flushes everything to disk; commit() then only renames.
  void finish();
  /// Finishes and renames; a file without one complete line on a full disk is not created.
  void commit();

 private:
  void flush();

  PartFile part_;
  std::int64_t on_disk_ = 0;  // bytes
  bool has_failed_ = false;   // a write failed; on_disk_ bytes are valid
  bool is_finished_ = false;
  std::string buffer_;
};

/// Writes a file, complete or not at all.
void write_file(const std::filesystem::path& file, std::string_view text);

/// Writes several files; all are on disk before the first is renamed.
void write_files(const std::filesystem::path& folder,
                 std::initializer_list<std::pair<const char*, std::string>> texts);

/// Throws InputError if one of `inputs` is the output file folder/name of one of `names`.
void protect_inputs(const std::filesystem::path& folder, std::initializer_list<const char*> names,
                    const std::vector<std::filesystem::path>& inputs);

/// Creates the folder. Throws InputError if it is not writable or has less than `bytes` of space.
void prepare_output_folder(const std::filesystem::path& folder, std::uintmax_t bytes);

}  // namespace stillkite
