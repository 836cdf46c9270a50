#include "io/dataset/trajectory_file.hpp"

#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

TEST(TrajectoryFile, TumReadsBackExactly) {
  const TemporaryFolder folder;
  std::string text = kTumHeader;
  std::vector<StampedPose> poses;
  for (int i = 0; i < 50; ++i) {
    const Eigen::Vector3d w(0.1 * i, -0.03 * i, 0.7);
    poses.push_back({{1403715273262142976 + i * 33333333LL},
                     {so3_exp(w), {0.1 * i, 1.0 / (i + 1), -i * 1e-7}}});
    text += tum_line(poses.back());
  }
  const std::vector<StampedPose> read = read_trajectory(folder.file("trajectory.tum", text));
  ASSERT_EQ(read.size(), poses.size());
  for (std::size_t i = 0; i < poses.size(); ++i) {
    EXPECT_EQ(read[i].stamp, poses[i].stamp);
    EXPECT_EQ(read[i].world_from_body.translation, poses[i].world_from_body.translation);
    EXPECT_LT(
        angle_between_rad(read[i].world_from_body.rotation, poses[i].world_from_body.rotation),
        1e-15);
  }
  EXPECT_EQ(read_trajectory(folder.path()).size(), poses.size());  // output folder of a run
}

TEST(TrajectoryFile, RejectsPosesWithoutStamps) {
  const TemporaryFolder folder;
  const auto file = folder.file("kitti.txt", "1 0 0 0 0 1 0 0 0 0 1 0\n1 0 0 1 0 1 0 0 0 0 1 0\n");
  EXPECT_EQ(input_error_of(folder, [&] { (void)read_trajectory(file); }),
            "kitti.txt: 12 columns are poses without time stamps (KITTI); convert them to TUM: t x "
            "y z qx qy qz qw");
}

TEST(TrajectoryFile, RejectsAnotherOrderOfTheQuaternionByName) {
  const TemporaryFolder folder;
  const auto error = [&](const char* name, const std::string& text) {
    const auto file = folder.file(name, text);
    return input_error_of(folder, [&] { (void)read_trajectory(file); });
  };
  EXPECT_EQ(error("a.csv", "#t,x,y,z,qx,qy,qz,qw\n1,0,0,0,0,0,0,1\n"),
            "a.csv:1: column 'qx': quaternion x by its name, expected quaternion w; the column "
            "order is time stamp, position x, y, z, quaternion w, x, y, z");
  EXPECT_EQ(error("a.tum", "# timestamp tx ty tz qw qx qy qz\n1 0 0 0 1 0 0 0\n"),
            "a.tum:1: column 'qw': quaternion w by its name, expected quaternion x; the column "
            "order is time stamp, position x, y, z, quaternion x, y, z, w");
  EXPECT_EQ(error("b.tum", std::string(kTumHeader) + "1 0 0 0 0 0 0 1\n"), "accepted");
}

TEST(TrajectoryFile, RejectsLatitudeAndLongitude) {
  const TemporaryFolder folder;
  for (const char* header : {"#t [ns],lat,lon,alt", "t [ns],Latitude [deg],Longitude [deg],h"}) {
    const auto file = folder.file("gnss.csv", std::string(header) + "\n1500000000,47.1,8.5,400\n");
    const std::string error = input_error_of(folder, [&] { (void)read_positions(file); });
    EXPECT_NE(error.find("positions must be in metres"), std::string::npos) << header << error;
  }
}

TEST(TrajectoryFile, EurocAndTumGiveEqualPoses) {
  const TemporaryFolder folder;
  const auto euroc = read_trajectory(folder.file(
      "euroc/data.csv",
      "#timestamp, px, py, pz, qw, qx, qy, qz, vx\n1500000000,1,2,3,0.5,-0.5,0.5,0.5,9\n"));
  const auto tum = read_trajectory(folder.file("a.txt", "1.5 1 2 3 -0.5 0.5 0.5 0.5\n"));
  ASSERT_EQ(euroc.size(), 1u);
  ASSERT_EQ(tum.size(), 1u);
  EXPECT_EQ(euroc[0].stamp, tum[0].stamp);
  EXPECT_EQ(euroc[0].world_from_body.translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(euroc[0].world_from_body.rotation.coeffs(), tum[0].world_from_body.rotation.coeffs());
  EXPECT_EQ(euroc[0].world_from_body.rotation.w(), 0.5);
}

// An estimate could be evaluated against itself.
TEST(TrajectoryFile, RejectsFolderWithTruthAndTrajectory) {
  const TemporaryFolder folder;
  folder.write("flight/state_groundtruth_estimate0/data.csv", "1500000000,1,2,3,1,0,0,0\n");
  EXPECT_TRUE(find_trajectory(folder.path() / "flight").has_value());
  folder.write("flight/trajectory.tum", "1.5 1 2 3 0 0 0 1\n");
  EXPECT_EQ(input_error_of(folder, [&] { (void)find_trajectory(folder.path() / "flight"); }),
            "flight: contains both a truth (state_groundtruth_estimate0/data.csv) and a run's "
            "trajectory.tum; give the file");
}

TEST(TrajectoryFile, FolderWithoutDataHasNoTrajectory) {
  const TemporaryFolder folder;
  folder.write("truth/sensor.yaml", "comment: none\n");
  EXPECT_FALSE(find_trajectory(folder.path() / "truth").has_value());
  EXPECT_THROW((void)find_trajectory(folder.path() / "nowhere"), InputError);
  EXPECT_THROW((void)read_trajectory(folder.path() / "truth"), InputError);
}

TEST(TrajectoryFile, RejectsInvalidPoses) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    return input_error_of(folder, [&] { (void)read_trajectory(folder.file("a.tum", text)); });
  };
  EXPECT_EQ(error("0 1 2 3 0 0 0 2\n"), "a.tum:1: the quaternion norm is 2, must be 1");
  EXPECT_EQ(error("0 1 2 3 0 0 0\n"),
            "a.tum:1: 7 columns, expected at least 8 separated by blanks");
  EXPECT_EQ(error("# only a comment\n"), "a.tum: no data row");
  EXPECT_EQ(error("0 nan 2 3 0 0 0 1\n"), "a.tum:1: column 2: 'nan' is not a finite number");
}

TEST(TrajectoryFile, FourColumnsArePositions) {
  const TemporaryFolder folder;
  for (const auto& file : {folder.file("leica0/data.csv",
                                       "#timestamp [ns], x [m], y [m], z [m]\n"
                                       "1500000000,1,2,3\n2000000000,2,2,3\n"),
                           folder.file("prism.txt", "# prism\n1.5 1 2 3\n2.0 2 2 3\n")}) {
    const auto poses = read_trajectory(file);
    ASSERT_EQ(poses.size(), 2u);
    EXPECT_EQ(poses[0].stamp.ns, 1500000000);
    EXPECT_EQ(poses[1].world_from_body.translation, Eigen::Vector3d(2, 2, 3));
    EXPECT_FALSE(has_attitude(poses));
  }
}

TEST(TrajectoryFile, IdentityInEveryRowIsNoAttitude) {
  const TemporaryFolder folder;
  const auto has = [&](const std::string& text) {
    return has_attitude(read_trajectory(folder.file("a.tum", text)));
  };
  EXPECT_FALSE(has("0 1 2 3 0 0 0 1\n1 2 2 3 0 0 0 1\n"));
  EXPECT_TRUE(has("0 1 2 3 0 0 0 1\n1 2 2 3 0 0 1e-6 1\n"));
  EXPECT_TRUE(has("0 1 2 3 0.5 0.5 0.5 0.5\n1 2 2 3 0.5 0.5 0.5 0.5\n"));
  EXPECT_EQ(read_positions(folder.file("b.tum", "0 1 2 3 0 0 0 0\n")).size(), 1u);
}

TEST(TrajectoryFile, ReadsWorldVelocities) {
  const TemporaryFolder folder;
  const auto velocities =
      read_velocities(folder.file("v.csv", "time [s],vx [m/s],vy [m/s],vz [m/s]\n0.5,1,2,3\n"));
  ASSERT_EQ(velocities.size(), 1u);
  EXPECT_EQ(velocities[0].stamp.ns, 500000000);
  EXPECT_EQ(velocities[0].velocity_in_world_m_s, Eigen::Vector3d(1, 2, 3));
}

TEST(TrajectoryFile, NamesTheUnitOfStampsThatAreNoSeconds) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& stamp) {
    return input_error_of(
        folder, [&] { (void)read_trajectory(folder.file("a.tum", stamp + " 1 2 3 0 0 0 1\n")); });
  };
  EXPECT_EQ(error("1403636579763555584.000000"),
            "a.tum:1: time stamp '1403636579763555584.000000' is too large for seconds, but "
            "plausible as nanoseconds; a file separated by blanks (TUM) has seconds: convert the "
            "stamps");
  EXPECT_NE(error("1403636579763555").find("plausible as microseconds"), std::string::npos);
  EXPECT_NE(error("1403636579763.5").find("plausible as milliseconds"), std::string::npos);
  EXPECT_NE(error("12345678901").find("milliseconds, microseconds or nanoseconds"),
            std::string::npos);
  EXPECT_EQ(error("0x1"), "a.tum:1: '0x1' is not a time stamp; expected a number");
}

TEST(TrajectoryFile, ReadsCameraTwists) {
  const TemporaryFolder folder;
  const auto twists =
      read_twists(folder.file("velocity.csv", "#timestamp [ns],v,,,w,,\n7,1,2,3,4,5,6\n"));
  ASSERT_EQ(twists.size(), 1u);
  EXPECT_EQ(twists[0].stamp.ns, 7);
  EXPECT_EQ(twists[0].twist.vector(), (Vector6d() << 1, 2, 3, 4, 5, 6).finished());
}

}  // namespace
}  // namespace stillkite
