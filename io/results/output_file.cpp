#include "io/results/output_file.hpp"

#include <fmt/core.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

[[noreturn]] void fail_to_write(const fs::path& file, int error) {
  throw std::runtime_error(fmt::format("{}: cannot be written: {}{}", file.string(),
                                       std::strerror(error),
                                       error == ENOSPC ? "; free some space or choose another "
                                                         "folder with --out"
                                                       : ""));
}

}  // namespace

OutputFile::OutputFile(fs::path file) : part_(std::move(file)) {}

void OutputFile::write(std::string_view text) {
  constexpr std::size_t kBlock = 1 << 14;
  buffer_ += text;
  is_finished_ = false;
  if (buffer_.size() >= kBlock) flush();
}

void OutputFile::flush() {
  const std::string block = std::exchange(buffer_, {});
  std::size_t done = 0;
  while (done < block.size()) {
    const ssize_t n = ::write(part_.descriptor(), block.data() + done, block.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) {
      const int error = n < 0 ? errno : ENOSPC;
      // truncate to the last complete line, which can be committed
      const std::size_t line = done > 0 ? block.rfind('\n', done - 1) : std::string::npos;
      if (line != std::string::npos) on_disk_ += static_cast<std::int64_t>(line) + 1;
      has_failed_ = true;
      if (ftruncate(part_.descriptor(), on_disk_) != 0) on_disk_ = 0;
      lseek(part_.descriptor(), on_disk_, SEEK_SET);
      fail_to_write(part_.file(), error);
    }
    done += static_cast<std::size_t>(n);
  }
  on_disk_ += static_cast<std::int64_t>(block.size());
}

void OutputFile::finish() {
  if (is_finished_) return;
  flush();
  // data before the rename, or a crash leaves an empty file
  if (fsync(part_.descriptor()) != 0) fail_to_write(part_.file(), errno);
  is_finished_ = true;
}

void OutputFile::commit() {
  finish();
  if (has_failed_ && on_disk_ == 0) return;  // no empty result file
  part_.rename();
}

void write_file(const fs::path& file, std::string_view text) {
  OutputFile out(file);
  out.write(text);
  out.commit();
}

void write_files(const fs::path& folder,
                 std::initializer_list<std::pair<const char*, std::string>> texts) {
  std::vector<OutputFile> files;
  files.reserve(texts.size());
  for (const auto& [name, text] : texts) {
    files.emplace_back(folder / name).write(text);
    files.back().finish();
  }
  for (OutputFile& file : files) file.commit();
}

void protect_inputs(const fs::path& folder, std::initializer_list<const char*> names,
                    const std::vector<fs::path>& inputs) {
  for (const fs::path& input : inputs) {
    for (const char* name : names) {
      std::error_code ignored;
      if (!fs::equivalent(folder / name, input, ignored)) continue;
      throw InputError(fmt::format(
          "{}: is an input file that the results would overwrite; choose another folder with --out",
          input.string()));
    }
  }
}

void prepare_output_folder(const fs::path& folder, std::uintmax_t bytes) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (failure || !fs::is_directory(folder)) {
    throw InputError(
        fmt::format("{}: cannot create the folder: {}; choose another with --out", folder.string(),
                    failure ? failure.message() : std::string("a file with this name exists")));
  }
  const OutputFile probe(folder / ".stillkite_probe");
  const fs::space_info space = fs::space(folder, failure);
  if (!failure && space.available < bytes) {
    throw InputError(fmt::format(
        "{}: {:.1f} MiB of disk space left, {:.1f} MiB required; free some space or choose another "
        "folder with --out",
        folder.string(), static_cast<double>(space.available) / 1048576.0,
        static_cast<double>(bytes) / 1048576.0));
  }
}

}  // namespace stillkite
