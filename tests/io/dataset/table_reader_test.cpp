#include "io/dataset/table_reader.hpp"

#include <sys/stat.h>

#include "tests/io/temporary_folder.hpp"

namespace stillkite {
namespace {

std::vector<std::pair<std::int64_t, double>> read(const std::filesystem::path& file) {
  TableReader table(file, Separator::comma, 2);
  std::vector<std::pair<std::int64_t, double>> rows;
  while (table.next()) {
    const Timestamp stamp = table.stamp();
    rows.emplace_back(stamp.ns, table.number(1));
  }
  return rows;
}

TEST(Stamps, AreExactBeyondDoublePrecision) {
  EXPECT_EQ(parse_stamp("1403715273262142976", 0)->ns, 1403715273262142976);
  EXPECT_EQ(parse_stamp("1403715273.262142976", 9)->ns, 1403715273262142976);
  EXPECT_EQ(parse_stamp("1.403715273262142976e+09", 9)->ns, 1403715273262142976);
  EXPECT_EQ(parse_stamp("-0.5", 9)->ns, -500000000);
  EXPECT_EQ(parse_stamp("2.5", 6)->ns, 2500000);
  EXPECT_EQ(parse_stamp("1e-10", 9)->ns, 0);
  EXPECT_EQ(parse_stamp("0.0000000005", 9)->ns, 1);
  for (const char* bad : {"", "nan", "1x", "1.2.3", "--1", "e5", "1e", "9e99", "."}) {
    EXPECT_FALSE(parse_stamp(bad, 9).has_value()) << bad;
  }
  for (const std::int64_t ns : {std::int64_t{0}, std::int64_t{-1}, std::int64_t{-1500000000},
                                std::int64_t{1403715273262142976}}) {
    EXPECT_EQ(parse_stamp(print_seconds({ns}), 9)->ns, ns);
  }
}

TEST(TableReader, ReadsWithAndWithoutHeader) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::int64_t, double>> expected{{10, 1.5}, {20, -2}};
  for (const char* names : {"", "#timestamp [ns],v\n", "t,v\n", "\xef\xbb\xbft,v\r\n",
                            "# a comment\n\n# t [ns], v\n"}) {
    EXPECT_EQ(read(folder.file("a.csv", std::string(names) + "10,1.5\r\n# between\n20, -2\n")),
              expected)
        << names;
  }
}

TEST(TableReader, FirstColumnNameGivesTimeUnit) {
  const TemporaryFolder folder;
  EXPECT_EQ(read(folder.file("a.csv", "t [s],v\n0.25,1\n"))[0].first, 250000000);
  EXPECT_EQ(read(folder.file("a.csv", "t [ms],v\n0.25,1\n"))[0].first, 250000);
  EXPECT_EQ(read(folder.file("a.csv", "t [us],v\n3,1\n"))[0].first, 3000);
  EXPECT_EQ(read(folder.file("a.csv", "t [ns],v\n3,1\n"))[0].first, 3);
}

TEST(TableReader, ReadsSemicolonsTabsQuotesAndCarriageReturns) {
  const TemporaryFolder folder;
  const std::vector<std::pair<std::int64_t, double>> expected{{10, 1.5}, {20, -2}};
  for (const char* text : {"t;v\n10;1.5\n20;-2\n", "#t\tv\n10\t1.5\n20\t-2\n",
                           "\"t\",\"v\"\n\"10\",\"1.5\"\n\"20\",\"-2\"\n", "t,v\r10,1.5\r20,-2\r",
                           "# Rev. 2; 3, a\n10\t1.5\n20\t-2\n"}) {
    EXPECT_EQ(read(folder.file("a.csv", text)), expected) << text;
  }
}

TEST(TableReader, ReadsNanosecondsWithAnExponent) {
  const TemporaryFolder folder;
  EXPECT_EQ(read(folder.file("a.csv", "1.403636579763555584e+18,2.5e+0\n"))[0].first,
            1403636579763555584);
  EXPECT_FALSE(has_fraction("0.000e+00"));
  EXPECT_FALSE(has_fraction("25e1"));
  EXPECT_TRUE(has_fraction("25e-1"));
  EXPECT_TRUE(has_fraction("1.5e-9"));
}

TEST(TableReader, RejectsColumnsOfAnotherQuantityOrAxis) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& names) {
    return input_error_of(folder, [&] {
      TableReader table(folder.file("a.csv", names + "\n1,0,0,0,0,0,9.8\n"), Separator::comma, 7,
                        vector_columns({Quantity::angular_rate, Quantity::acceleration}));
      while (table.next()) (void)table.number(1);
    });
  };
  for (const char* names :
       {"timestamp [ns],w_RS_S_x [rad s^-1],w_RS_S_y [rad s^-1],w_RS_S_z [rad s^-1],a_RS_S_x [m "
        "s^-2],a_RS_S_y [m s^-2],a_RS_S_z [m s^-2]",
        "TimeNS,GyrX,GyrY,GyrZ,AccX,AccY,AccZ", "t,wx,wy,wz,ax,ay,az", "a,b,c,d,e,f,g",
        "%time,field.angular_velocity.x,field.angular_velocity.y,field.angular_velocity.z,"
        "field.linear_acceleration.x,field.linear_acceleration.y,field.linear_acceleration.z",
        "timestamp,gyro_rad[0],gyro_rad[1],gyro_rad[2],accelerometer_m_s2[0],accelerometer_m_s2[1],"
        "accelerometer_m_s2[2]",
        "timestamp,angular_velocity.x,y,z,ax,ay,az"}) {
    EXPECT_EQ(error(names), "accepted") << names;
  }
  EXPECT_EQ(error("t,mag_x,mag_y,mag_z,gyro_x,gyro_y,gyro_z"),
            "a.csv:1: column 'mag_x': magnetic field x by its name, expected angular rate x; the "
            "column order is time stamp, angular rate x, y, z, acceleration x, y, z");
  EXPECT_EQ(error("seq,t,wx,wy,wz,ax,ay"),
            "a.csv:1: column 'seq': counter by its name; the first column must be the time stamp");
  for (const char* names :
       {"t,ax,ay,az,wx,wy,wz", "t,wy,wx,wz,ax,ay,az", "t,qx,qy,qz,qw,wx,wy", "t,wx,wy,wz,vx,vy,vz",
        "t,roll,pitch,yaw,ax,ay,az", "t,wx,wy,wz,acc_north,acc_east,a_down"}) {
    EXPECT_NE(error(names), "accepted") << names;
  }
}

TEST(ColumnName, GivesQuantityAndAxis) {
  const auto text = [](const char* name) { return description_of(column_named(name)); };
  EXPECT_EQ(text("p_RS_R_x [m]"), "position x");
  EXPECT_EQ(text("q_RS_w []"), "quaternion w");
  EXPECT_EQ(text("field.orientation.x"), "quaternion x");
  EXPECT_EQ(text("w_RS_S_z [rad s^-1]"), "angular rate z");
  EXPECT_EQ(text("angular_acceleration_y"), "angular acceleration y");
  EXPECT_EQ(text("vel_n_m_s"), "velocity");  // unit after the axis
  EXPECT_EQ(text("vel_n"), "velocity y");
  EXPECT_EQ(text("ve [m/s]"), "velocity x");
  EXPECT_EQ(text("v_down"), "velocity down");
  EXPECT_EQ(text("ty"), "position y");
  EXPECT_EQ(text("gps_lat"), "latitude or longitude");
  EXPECT_EQ(text("TimeUS"), "component");
  for (const char* name : {"", "h", "value", "index_max", "b_w_RS_S_x", "temperature", "w"}) {
    EXPECT_FALSE(column_named(name).quantity) << name;
  }
}

TEST(TableReader, ErrorsNameFileLineAndRemedy) {
  const TemporaryFolder folder;
  const auto error = [&](const std::string& text) {
    return input_error_of(folder, [&] { (void)read(folder.file("a.csv", text)); });
  };
  EXPECT_EQ(error("t,v\n1,2\n2,nan\n"), "a.csv:3: column 'v': 'nan' is not a finite number");
  EXPECT_EQ(error("1,2\n2,inf\n"), "a.csv:2: column 2: 'inf' is not a finite number");
  EXPECT_EQ(error("1,2\n2,fast\n"), "a.csv:2: column 2: 'fast' is not a finite number");
  EXPECT_EQ(error("1,2\n2,\n"), "a.csv:2: column 2: '' is not a finite number");
  EXPECT_EQ(error("1,2\nx,3\n"),
            "a.csv:2: 'x' is not a time stamp; expected a number, remove lines of text from the "
            "table");
  EXPECT_EQ(error("nan,3\n"), "a.csv:1: 'nan' is not a time stamp; expected a number");
  EXPECT_EQ(error("1,2\n3\n"), "a.csv:2: 1 columns, expected at least 2 separated by commas");
  EXPECT_EQ(error("t,v\n1,19,8\n"),
            "a.csv:2: 3 columns, but the header names 2; do not use decimal commas");
  EXPECT_EQ(error("5,2\n5,3\n"),
            "a.csv:2: time stamp 5 repeats that of line 1; sort the file and remove duplicates");
  EXPECT_EQ(
      error("5,2\n# c\n4,3\n"),
      "a.csv:3: time stamp 4 is earlier than that of line 1; sort the file and remove duplicates");
  EXPECT_EQ(error("t [s],v\n2.5,2\n3,2\n0,3\n"),
            "a.csv:4: time stamp 0 is 3 s earlier than that of line 3: the clock was reset, or a "
            "counter wrapped; correct the stamps from here, or remove one part");
  EXPECT_EQ(
      error("0.5,2\n"),
      "a.csv:1: time stamp '0.5' is not an integer of nanoseconds; for seconds name the column "
      "'timestamp [s]' in the header");
  EXPECT_EQ(error("1,2\n2"),
            "a.csv:2: 1 columns, expected at least 2 separated by commas; the file ends within "
            "this line: remove it if it is incomplete");
  EXPECT_EQ(error("1 2\n"),
            "a.csv:1: 1 columns, expected at least 2 separated by commas; this line is separated "
            "by blanks: use commas");
  EXPECT_EQ(error("1;0,5\n"),
            "a.csv:1: column 2: '0,5' is not a finite number; use decimal points");
  EXPECT_EQ(error(std::string("1,2\n2,3\n\0\0", 10)),
            "a.csv:3: zero bytes; the file is no text, or damaged there (interrupted recording): "
            "remove the damaged lines");
  EXPECT_EQ(error(std::string("\xff\xfe\x31\0", 4)),
            "a.csv: the text is in UTF-16; save it as UTF-8");
  EXPECT_EQ(error(""), "a.csv: the file is empty");
  EXPECT_EQ(input_error_of(folder, [&] { (void)read(folder.path() / "none.csv"); }),
            "none.csv: no such file; check the path");
  ASSERT_EQ(mkfifo((folder.path() / "pipe.csv").c_str(), 0600), 0);
  EXPECT_EQ(input_error_of(folder, [&] { (void)read(folder.path() / "pipe.csv"); }),
            "pipe.csv: is a pipe or a device, expected a file");
}

}  // namespace
}  // namespace stillkite
