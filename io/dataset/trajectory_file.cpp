#include "io/dataset/trajectory_file.hpp"

#include <fmt/format.h>

#include <fmt/core.h>

#include "io/dataset/table_geometry.hpp"
#include "io/text_file.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

// Separator of the first line that is not a comment.
Separator separator_of(const fs::path& file) {
  const std::string text = read_text_file(file);
  std::size_t at = 0;
  while (at < text.size()) {
    const std::size_t end = std::min(text.find('\n', at), text.size());
    const std::string_view line(text.data() + at, end - at);
    at = end + 1;
    if (line.empty() || line[0] == '#' || line[0] == '\r') continue;
    return line.find(',') != std::string_view::npos ? Separator::comma : Separator::blank;
  }
  throw InputError(file.string() + ": no data row");
}

}  // namespace

std::optional<fs::path> find_trajectory(const fs::path& path) {
  if (!fs::exists(path)) throw InputError(path.string() + ": no such file or folder");
  if (!fs::is_directory(path)) return path;
  std::optional<fs::path> found;
  for (const char* name : {"data.csv", "mav0/state_groundtruth_estimate0/data.csv",
                           "state_groundtruth_estimate0/data.csv"}) {
    if (!found && fs::exists(path / name)) found = path / name;
  }
  if (!fs::exists(path / "trajectory.tum")) return found;
  if (found) {
    throw InputError(
        fmt::format("{}: contains both a truth ({}) and a run's trajectory.tum; give the file",
                    path.string(), found->lexically_relative(path).string()));
  }
  return path / "trajectory.tum";
}

std::vector<StampedPose> read_trajectory(const fs::path& path) {
  const std::optional<fs::path> file = find_trajectory(path);
  if (!file) {
    throw InputError(path.string() +
                     ": no trajectory in this folder; expected data.csv (EuRoC) or "
                     "trajectory.tum");
  }
  const Separator separator = separator_of(*file);
  TableReader table(*file, separator, 8, std::vector(3, Unit::metre));
  std::vector<StampedPose> poses;
  while (table.next()) {
    const Timestamp stamp = table.stamp();
    const Eigen::Quaterniond rotation =
        separator == Separator::comma ? quaternion_at(table, 4, 5) : quaternion_at(table, 7, 4);
    poses.push_back({stamp, {rotation, vector_at(table, 1)}});
  }
  if (poses.empty()) throw InputError(file->string() + ": no data row");
  return poses;
}

std::vector<StampedTwist> read_twists(const fs::path& file) {
  TableReader table(file, Separator::comma, 7,
                    units_of_vectors(Unit::metre_per_s, Unit::radian_per_s));
  std::vector<StampedTwist> twists;
  while (table.next()) {
    const Timestamp stamp = table.stamp();
    twists.push_back({stamp, {vector_at(table, 1), vector_at(table, 4)}});
  }
  return twists;
}

std::string tum_line(const StampedPose& pose) {
  const Eigen::Vector3d& t = pose.world_from_body.translation;
  const Eigen::Quaterniond& q = pose.world_from_body.rotation;
  return fmt::format("{} {} {} {} {} {} {} {}\n", print_seconds(pose.stamp), t.x(), t.y(), t.z(),
                     q.x(), q.y(), q.z(), q.w());
}

}  // namespace stillkite
