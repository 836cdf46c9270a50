#include "io/results/output_folder.hpp"

#include "geometry/fields.hpp"
#include "io/results/output_file.hpp"

namespace stillkite {
namespace fs = std::filesystem;

OutputFolder::OutputFolder(const fs::path& folder, std::uintmax_t bytes)
    : folder_(fs::absolute(folder).lexically_normal()) {
  if (!folder_.has_filename()) folder_ = folder_.parent_path();  // "out/" is "out"
  std::error_code failure;
  // write to the link's target
  if (fs::is_symlink(folder_, failure)) folder_ = fs::weakly_canonical(folder_);
  part_ = fs::path(folder_) += ".part";
  reject_existing(folder);
  if (fs::exists(part_, failure)) {
    throw InputError(part_.string() + ": already exists, possibly left by a killed run; remove it");
  }
  prepare_output_folder(part_, bytes);
}

void OutputFolder::reject_existing(const fs::path& folder) {
  std::error_code failure;
  if (fs::exists(folder, failure) &&
      !(fs::is_directory(folder, failure) && fs::is_empty(folder, failure))) {
    throw InputError(folder.string() +
                     ": already exists; remove it or choose another folder with --out");
  }
}

OutputFolder::~OutputFolder() {
  if (committed_) return;
  std::error_code ignored;
  fs::remove_all(part_, ignored);
}

void OutputFolder::commit() {
  fs::rename(part_, folder_);
  committed_ = true;
}

}  // namespace stillkite
