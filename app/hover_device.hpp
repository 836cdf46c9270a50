#pragma once

#include <Eigen/Geometry>
#include <atomic>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <thread>

#include "app/fly_config.hpp"
#include "live/link/line_splitter.hpp"
#include "live/link/port.hpp"
#include "live/link/pseudo_terminal.hpp"
#include "live/mavlink/packet.hpp"
#include "live/stream/video_sender.hpp"
#include "live/tether/station_lines.hpp"
#include "simulation/hover/hover_sensors.hpp"
#include "simulation/hover/hover_trial.hpp"
#include "simulation/hover/hover_video.hpp"
#include "simulation/random.hpp"

namespace stillkite {

/// Camera of a simulated drone: renders, codes and sends the images on its own thread.
class DeviceCamera {
 public:
  /// `config` and `world` must outlive it.
  DeviceCamera(const HoverConfig& config, const HoverWorld& world, const Trial& trial);
  ~DeviceCamera();
  DeviceCamera(const DeviceCamera&) = delete;
  DeviceCamera& operator=(const DeviceCamera&) = delete;

  /// Exposes an image now, with the state of the plant at the simulation's time `now`. The image is
  /// lost if two others are not coded yet.
  void expose(const DroneTruth& truth, Timestamp now, const FaultEffect& fault);

  /// Images that are lost, or were coded after the camera's latency, since the machine is too slow.
  [[nodiscard]] std::int64_t lost() const { return lost_; }
  [[nodiscard]] std::int64_t late() const { return late_; }

 private:
  struct Exposure {
    DroneTruth truth;
    Timestamp now;
    Timestamp local;
    FaultEffect fault;
  };
  void send_all();
  void send(const Exposure& exposure);

  const HoverConfig& config_;
  HoverVideo video_;
  VideoSender sender_;
  Random jitter_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Exposure> waiting_;
  std::atomic<std::int64_t> lost_ = 0, late_ = 0;
  bool closed_ = false;
  std::thread thread_;  // last: uses all other members
};

/// Ground station and autopilot of a simulated drone.
class DeviceStation {
 public:
  /// `station_from_world`: axes of !Attitude, at the start.
  DeviceStation(const HoverConfig& config, const std::filesystem::path& terminal,
                const Eigen::Quaterniond& station_from_world);

  /// Sends the readings that are due.
  void send(const HoverReadings& readings, Timestamp now);

  /// Command in use; zero after half a second without lines, as for a cut cable.
  [[nodiscard]] TetherCommand command(Timestamp now);
  [[nodiscard]] bool has_received() const { return last_line_.has_value(); }

 private:
  void send_imu(const AttitudeReading& reading);
  void send_tether(const TetherSample& sample);

  HoverConfig config_;
  Eigen::Quaterniond station_from_world_;
  PseudoTerminal terminal_;
  Port mavlink_;
  mavlink::Sender sender_;
  LineSplitter lines_;
  std::deque<TetherSample> waiting_;
  Eigen::Quaterniond attitude_ = Eigen::Quaterniond::Identity();
  TetherCommand command_;
  std::optional<Timestamp> last_line_;
};

/// Stamp of the simulation's time on the drone's clock.
[[nodiscard]] Timestamp device_stamp(const ServeConfig& config, Timestamp now);

/// Configuration of `stillkite fly` for the drone of a trial.
[[nodiscard]] FlyConfig device_flight(const HoverConfig& config,
                                      const std::filesystem::path& terminal,
                                      double initial_height_m);

/// Simulates a trial in real time as a device with video, MAVLink and ground station. Writes
/// flight.yaml for `stillkite fly` into the folder first. The station moves one second after the
/// first command. Ends with the trial, or if interrupted; `estimate_errors` stay empty.
[[nodiscard]] TrialRecord serve_trial(const HoverConfig& config, const HoverWorld& world,
                                      const Trial& trial, const std::filesystem::path& folder);

}  // namespace stillkite
