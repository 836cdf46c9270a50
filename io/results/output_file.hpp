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

/// A file that appears under its name whole or not at all: a PartFile, renamed by commit(), removed
/// if that is never called. Not being able to create it is an InputError, not
/// being able to write on a std::runtime_error; both name the file and the reason.
class OutputFile {
 public:
  explicit OutputFile(std::filesystem::path file);

  /// Appends. Where the disk is full the file ends after a whole line and can still be committed.
  void write(std::string_view text);
  /// All of it is on the disk, and only the name is missing.
  void finish();
  /// Of a file that the disk had no line's room for nothing is left.
  void commit();

 private:
  void flush();

  PartFile part_;
  std::int64_t on_disk_ = 0;  // bytes
  bool has_failed_ = false;   // to write; what is on the disk may be kept
  bool is_finished_ = false;
  std::string waiting_;
};

/// The text under that name, whole or not at all.
void write_file(const std::filesystem::path& file, std::string_view text);

/// The texts under their names: all are on the disk before the first gets its name.
void write_files(const std::filesystem::path& folder,
                 std::initializer_list<std::pair<const char*, std::string>> texts);

/// Throws InputError where one of the `inputs` is the file of that name, which is to be written.
void protect_inputs(const std::filesystem::path& folder, std::initializer_list<const char*> names,
                    const std::vector<std::filesystem::path>& inputs);

/// Makes the folder and proves that files can be written there and that it has room for `bytes`.
/// Throws InputError otherwise.
void prepare_output_folder(const std::filesystem::path& folder, std::uintmax_t bytes);

}  // namespace stillkite
