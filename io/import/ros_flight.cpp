#include "io/import/ros_flight.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <utility>
#include <vector>

#include "io/import/mcap.hpp"
#include "io/import/rosbag.hpp"

namespace stillkite {
namespace {

Eigen::Vector3d next_vector(RosFields& fields) {
  const auto x = fields.next<double>(), y = fields.next<double>(), z = fields.next<double>();
  return {x, y, z};
}

// Length of the common beginning of two topics: those of one camera share a namespace.
std::ptrdiff_t common_length(std::string_view a, std::string_view b) {
  return std::ranges::mismatch(a, b).in1 - a.begin();
}

class RosFlightReader {
 public:
  void take(const RosMessage& message) {
    const bool is_image =
        message.type == "sensor_msgs/Image" || message.type == "sensor_msgs/CompressedImage";
    std::vector<std::string>& topics = topics_[is_image ? kImages : std::string(message.type)];
    if (std::ranges::find(topics, message.topic) == topics.end()) {
      topics.emplace_back(message.topic);
      RosFields fields(message);
      if (message.type == "sensor_msgs/CameraInfo") take_camera(fields, message.topic);
    }
    if (message.topic != topics.front()) return;
    RosFields fields(message);
    if (message.type == "sensor_msgs/Imu") {
      take_imu(fields);
    } else if (message.type == "sensor_msgs/NavSatFix") {
      take_position(fields);
    } else if (message.type == "sensor_msgs/Range") {
      take_range(fields);
    }
  }

  RosFlight finish(std::size_t damaged) {
    ImportedFlight& flight = out_.flight;
    for (const char* type :
         {kImages, "sensor_msgs/Imu", "sensor_msgs/NavSatFix", "sensor_msgs/Range"}) {
      const auto found = topics_.find(type);
      if (found == topics_.end()) continue;
      const std::vector<std::string>& topics = found->second;
      if (topics.size() == 1) {
        flight.found(fmt::format("{}: topic {}", type, topics.front()));
      } else {
        flight.assumed(
            fmt::format("{}: topic {}, the first of {}", type, topics.front(), topics.size()));
      }
    }
    if (const auto images = topics_.find(kImages); images != topics_.end()) {
      out_.image_topic = images->second.front();
    }
    select_camera();
    if (lacks_stamps_) flight.assumed("clock: time of recording of messages without a stamp");
    if (!flight.angular_rate_in_body_rad_s.stamps.empty()) {
      flight.assumed("imu: mounted with x forward, y left, z up (imu.rotation_wxyz)");
    }
    if (!flight.range_m.stamps.empty()) flight.assumed("range finder: faces down");
    if (damaged > 0) flight.missing(fmt::format("{} damaged or cut off parts", damaged));
    return std::move(out_);
  }

 private:
  static constexpr const char* kImages = "images";

  // Calibration of the camera whose namespace agrees best with that of the images.
  void select_camera() {
    if (cameras_.empty()) return;
    const std::string_view images = out_.image_topic ? *out_.image_topic : std::string_view();
    const auto best = std::ranges::max_element(
        cameras_, {}, [&](const auto& camera) { return common_length(camera.first, images); });
    out_.flight.camera = best->second;
    const std::string text = fmt::format("sensor_msgs/CameraInfo: topic {}", best->first);
    if (cameras_.size() == 1) {
      out_.flight.found(text);
    } else {
      out_.flight.assumed(fmt::format("{}, the best name of {}", text, cameras_.size()));
    }
  }

  Timestamp header_of(RosFields& fields) {
    const Timestamp stamp = fields.header();
    lacks_stamps_ = lacks_stamps_ || fields.lacks_stamp();
    return stamp;
  }

  void take_imu(RosFields& fields) {
    constexpr int kCovariance = 9;
    const Timestamp stamp = header_of(fields);
    std::array<double, 4> q{};  // x y z w
    for (double& component : q) component = fields.next<double>();
    const auto has_no_orientation = fields.next<double>() == -1;
    fields.skip_doubles(kCovariance - 1);
    const Eigen::Vector3d rate = next_vector(fields);
    fields.skip_doubles(kCovariance);
    const Eigen::Vector3d force = next_vector(fields);
    if (!fields.is_valid()) return;
    ImportedFlight& flight = out_.flight;
    append(flight.angular_rate_in_body_rad_s, stamp, rate, flight.rejected);
    append(flight.specific_force_in_body_m_s2, stamp, force, flight.rejected);
    const Eigen::Quaterniond attitude(q[3], q[0], q[1], q[2]);
    // without an estimate drivers send zeros or the identity
    if (has_no_orientation || !is_valid(attitude) || std::abs(attitude.w()) == 1) return;
    append(flight.attitude, stamp, attitude, flight.rejected);
  }

  void take_position(RosFields& fields) {
    const Timestamp stamp = header_of(fields);
    const auto status = fields.next<std::int8_t>();
    (void)fields.next<std::uint16_t>();
    const auto latitude = fields.next<double>(), longitude = fields.next<double>();
    const auto altitude = fields.next<double>();
    if (!fields.is_valid() || status < 0) return;
    append(out_.flight.positions, stamp,
           GeodeticPosition{
               .latitude_deg = latitude, .longitude_deg = longitude, .altitude_m = altitude},
           out_.flight.rejected);
  }

  void take_range(RosFields& fields) {
    const Timestamp stamp = header_of(fields);
    (void)fields.next<std::uint8_t>();
    (void)fields.next<float>();
    const auto least = fields.next<float>(), most = fields.next<float>();
    const auto range = fields.next<float>();
    if (!fields.is_valid() || !(range >= least && range <= most)) return;
    append(out_.flight.range_m, stamp, static_cast<double>(range), out_.flight.rejected);
  }

  void take_camera(RosFields& fields, std::string_view topic) {
    (void)fields.header();
    CameraConfig camera;
    constexpr std::uint32_t kMinSide_px = 16, kMaxSide_px = 100'000;
    const auto height = fields.next<std::uint32_t>(), width = fields.next<std::uint32_t>();
    if (std::min(width, height) < kMinSide_px || std::max(width, height) > kMaxSide_px) return;
    camera.height_px = static_cast<int>(height);
    camera.width_px = static_cast<int>(width);
    const std::string_view model = fields.text();
    const auto coefficients = fields.next<std::uint32_t>();
    for (std::uint32_t i = 0; i < coefficients && fields.is_valid(); ++i) {
      camera.coefficients.push_back(fields.next<double>());
    }
    std::array<double, 9> K{};
    for (double& element : K) element = fields.next<double>();
    if (!fields.is_valid() || K[0] <= 0 || K[4] <= 0 || camera.coefficients.size() > 14) return;
    camera.focal_x_px = K[0];
    camera.centre_x_px = K[2];
    camera.focal_y_px = K[4];
    camera.centre_y_px = K[5];
    if (model == "plumb_bob" || model == "rational_polynomial") {
      camera.distortion = DistortionModel::radial_tangential;
    } else if (model == "equidistant" || model == "fisheye") {
      camera.distortion = DistortionModel::equidistant;
    } else if (!model.empty()) {
      out_.flight.missing(fmt::format("calibration: lens model {} of CameraInfo", model));
      return;
    }
    if (model.empty()) camera.coefficients.clear();
    cameras_.emplace_back(topic, std::move(camera));
  }

  RosFlight out_;
  std::map<std::string, std::vector<std::string>> topics_;     // of each type
  std::vector<std::pair<std::string, CameraConfig>> cameras_;  // topic, calibration
  bool lacks_stamps_ = false;
};

}  // namespace

std::size_t read_ros_messages(const std::filesystem::path& file, RecordingFormat format,
                              const TakeRosMessage& take) {
  switch (format) {
    case RecordingFormat::mcap:
      return read_mcap(file, take);
    case RecordingFormat::rosbag:
      return read_rosbag(file, take);
    case RecordingFormat::ros_database:
      return read_ros_database(file, take);
    default:
      return 0;
  }
}

RosFlight read_ros_flight(const std::filesystem::path& file, RecordingFormat format,
                          const std::function<void()>& poll) {
  RosFlightReader reader;
  const std::size_t damaged = read_ros_messages(file, format, [&](const RosMessage& message) {
    poll();
    reader.take(message);
  });
  return reader.finish(damaged);
}

}  // namespace stillkite
