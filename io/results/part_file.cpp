#include "io/results/part_file.hpp"

#include <fcntl.h>
#include <fmt/core.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "geometry/fields.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

constexpr const char* kExtension = ".part";

fs::path part_name(const fs::path& file, int attempt) {
  return fs::path(file) += attempt == 0 ? fmt::format(".{}{}", getpid(), kExtension)
                                        : fmt::format(".{}-{}{}", getpid(), attempt, kExtension);
}

bool is_part_of(const std::string& name, const std::string& file) {
  if (!name.starts_with(file) || !name.ends_with(kExtension)) return false;
  const std::size_t min_size = file.size() + std::strlen(kExtension);
  if (name.size() <= min_size) return name.size() == min_size;
  const std::string between = name.substr(file.size(), name.size() - min_size);
  return between[0] == '.' && between.find_first_not_of("0123456789-", 1) == std::string::npos;
}

// False if another process removed the file between open and flock.
bool lock_new_file(int descriptor) {
  flock(descriptor, LOCK_EX | LOCK_NB);
  struct stat status {};
  return fstat(descriptor, &status) == 0 && status.st_nlink > 0;
}

// A lockable file has no writer.
void remove_unless_written(const fs::path& part) {
  const int descriptor = open(part.c_str(), O_WRONLY | O_NONBLOCK | O_NOFOLLOW | O_CLOEXEC);
  if (descriptor < 0) return;
  struct stat status {};
  const bool is_file = fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode);
  if (is_file && flock(descriptor, LOCK_EX | LOCK_NB) == 0) unlink(part.c_str());
  close(descriptor);
}

}  // namespace

PartFile::PartFile(fs::path file) : file_(std::move(file)) {
  constexpr int kMaxAttempts = 1000;
  remove_stale_parts(file_);
  for (int attempt = 0; attempt < kMaxAttempts; ++attempt) {
    part_ = part_name(file_, attempt);
    descriptor_ = open(part_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor_ < 0 && errno != EEXIST) break;
    if (descriptor_ >= 0 && lock_new_file(descriptor_)) return;
    if (descriptor_ >= 0) close(descriptor_);
  }
  throw InputError(fmt::format("{}: cannot be created: {}; choose another folder with --out",
                               file_.string(), std::strerror(errno)));
}

PartFile::PartFile(PartFile&& other) noexcept
    : file_(std::move(other.file_)),
      part_(std::move(other.part_)),
      descriptor_(std::exchange(other.descriptor_, -1)) {}

PartFile::~PartFile() {
  if (descriptor_ < 0) return;
  unlink(part_.c_str());
  close(descriptor_);
}

void PartFile::rename() {
  if (std::rename(part_.c_str(), file_.c_str()) != 0) {
    throw std::runtime_error(
        fmt::format("{}: cannot be written: {}", file_.string(), std::strerror(errno)));
  }
  close(std::exchange(descriptor_, -1));
}

void remove_stale_parts(const fs::path& file) {
  const fs::path folder = file.has_parent_path() ? file.parent_path() : fs::path(".");
  const std::string name = file.filename().string();
  std::error_code failure;
  for (fs::directory_iterator at(folder, failure), end; !failure && at != end;
       at.increment(failure)) {
    if (is_part_of(at->path().filename().string(), name)) remove_unless_written(at->path());
  }
}

FolderLock::FolderLock(const fs::path& folder, WhenLocked when_locked)
    : descriptor_(open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC)) {
  const int operation = (when_locked == WhenLocked::share ? LOCK_SH : LOCK_EX) |
                        (when_locked == WhenLocked::wait ? 0 : LOCK_NB);
  while (descriptor_ >= 0 && flock(descriptor_, operation) != 0) {
    if (errno == EINTR) continue;
    if (errno != EWOULDBLOCK) return;
    close(descriptor_);
    throw InputError(folder.string() +
                     ": another process writes to this folder; wait for its end "
                     "or choose another folder with --out");
  }
}

FolderLock::~FolderLock() {
  if (descriptor_ >= 0) close(descriptor_);
}

}  // namespace stillkite
