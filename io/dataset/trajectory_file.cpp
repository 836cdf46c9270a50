#include "io/dataset/trajectory_file.hpp"

#include <fmt/format.h>

#include <fmt/core.h>

#include <algorithm>
#include <cctype>
#include <iterator>
#include <sstream>

#include "io/dataset/table_geometry.hpp"
#include "io/text_file.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

struct Layout {
  Separator separator = Separator::blank;
  std::size_t columns = 0;  // of the first row; 0 without one
};

std::size_t count_cells(std::string_view line, Separator separator) {
  if (separator == Separator::comma) {
    const char delimiter = line.find(';') == std::string_view::npos ? ',' : ';';
    return std::ranges::count(line, delimiter) + std::size_t{1};
  }
  std::istringstream words{std::string(line)};
  return std::distance(std::istream_iterator<std::string>(words), {});
}

// Separator of the first line that is not a comment.
Layout layout_of(const fs::path& file) {
  std::istringstream text(read_text_file(file));
  std::optional<Layout> layout;
  for (std::string line; std::getline(text, line);) {
    if (line.empty() || line[0] == '#' || line[0] == '\r') continue;
    const bool is_first = !layout;
    if (is_first) {
      layout.emplace().separator =
          line.find_first_of(",;") != std::string::npos ? Separator::comma : Separator::blank;
    }
    const bool is_header = std::isalpha(static_cast<unsigned char>(line[0])) != 0;
    if (is_header && is_first) continue;
    layout->columns = count_cells(line, layout->separator);
    break;
  }
  if (!layout) throw InputError(file.string() + ": no data row");
  return *layout;
}

fs::path trajectory_of(const fs::path& path) {
  std::optional<fs::path> file = find_trajectory(path);
  if (file) return *file;
  throw InputError(path.string() +
                   ": no trajectory in this folder; expected data.csv (EuRoC) or "
                   "trajectory.tum");
}

std::vector<Column> pose_columns(Separator separator, bool with_attitude) {
  std::vector<Column> columns = vector_columns({Quantity::position});
  if (!with_attitude) return columns;
  for (const char axis : std::string_view(separator == Separator::comma ? "wxyz" : "xyzw")) {
    columns.push_back({Quantity::quaternion, axis});
  }
  return columns;
}

std::vector<StampedPose> read_poses(const fs::path& file, Separator separator, bool with_attitude) {
  TableReader table(file, separator, with_attitude ? 8 : 4, pose_columns(separator, with_attitude));
  std::vector<StampedPose> poses;
  while (table.next()) {
    const Timestamp stamp = table.stamp();
    Eigen::Quaterniond rotation = Eigen::Quaterniond::Identity();
    if (with_attitude) {
      rotation =
          separator == Separator::comma ? quaternion_at(table, 4, 5) : quaternion_at(table, 7, 4);
    }
    poses.push_back({stamp, {rotation, vector_at(table, 1)}});
  }
  if (poses.empty()) throw InputError(file.string() + ": no data row");
  return poses;
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
  const fs::path file = trajectory_of(path);
  const Layout layout = layout_of(file);
  constexpr std::size_t kKitti = 12;
  if (layout.separator == Separator::blank && layout.columns == kKitti) {
    throw InputError(file.string() +
                     ": 12 columns are poses without time stamps (KITTI); convert them to TUM: t x "
                     "y z qx qy qz qw");
  }
  return read_poses(file, layout.separator, layout.columns != 4);
}

std::vector<StampedPose> read_positions(const fs::path& path) {
  const fs::path file = trajectory_of(path);
  return read_poses(file, layout_of(file).separator, false);
}

bool has_attitude(std::span<const StampedPose> poses) {
  const auto is_identity = [](const StampedPose& pose) {
    return pose.world_from_body.rotation.vec().isZero(0);
  };
  return poses.size() < 2 || !std::ranges::all_of(poses, is_identity);
}

std::vector<StampedTwist> read_twists(const fs::path& file) {
  TableReader table(file, Separator::comma, 7,
                    vector_columns({Quantity::velocity, Quantity::angular_rate}));
  std::vector<StampedTwist> twists;
  while (table.next()) {
    const Timestamp stamp = table.stamp();
    twists.push_back({stamp, {vector_at(table, 1), vector_at(table, 4)}});
  }
  return twists;
}

std::vector<StampedVelocity> read_velocities(const fs::path& file) {
  TableReader table(file, Separator::comma, 4, vector_columns({Quantity::velocity}));
  std::vector<StampedVelocity> velocities;
  while (table.next()) {
    const Timestamp stamp = table.stamp();
    velocities.push_back({stamp, vector_at(table, 1)});
  }
  return velocities;
}

std::size_t count_columns(const fs::path& file) {
  return layout_of(file).columns;
}

std::string tum_line(const StampedPose& pose) {
  const Eigen::Vector3d& t = pose.world_from_body.translation;
  const Eigen::Quaterniond& q = pose.world_from_body.rotation;
  return fmt::format("{} {} {} {} {} {} {} {}\n", print_seconds(pose.stamp), t.x(), t.y(), t.z(),
                     q.x(), q.y(), q.z(), q.w());
}

}  // namespace stillkite
