#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <deque>
#include <filesystem>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <thread>

#include "live/record/flight_files.hpp"

namespace stillkite {

/// Writes the record of a flight, row by row, on its own thread. What was added is in the file
/// system after milliseconds and on disk after a second. Thread-safe.
class FlightRecord {
 public:
  /// Creates the folder. Throws InputError if it has files already or is not writable.
  explicit FlightRecord(const std::filesystem::path& folder);
  /// Writes everything added before.
  ~FlightRecord();
  FlightRecord(const FlightRecord&) = delete;
  FlightRecord& operator=(const FlightRecord&) = delete;

  /// Begins a session; the packets that follow belong to it.
  void begin_session(const AVCodecParameters& codec, AVRational time_base);
  void add_packet(const AVPacket& packet, Timestamp arrival);
  void add_frame(const RecordedFrame& frame);
  void add_message(const RecordedMessage& message);
  /// Row of estimates.csv, or its header.
  void add_estimate(const std::string& row);
  /// Row of commands.csv, or its header, which creates the file. Of one thread; throws InputError
  /// if the file cannot be created.
  void add_command(const std::string& row);

  /// First write error; the record ended there.
  [[nodiscard]] std::optional<std::string> failure();

 private:
  enum File : std::size_t {
    sessions,
    packets,
    video,
    frames,
    telemetry,
    estimates,
    commands,
    kFiles
  };
  struct Block {
    File file{};
    std::string bytes;
  };

  void append(File file, std::string bytes);
  void write_all();
  void write(const Block& block);
  void fail(const std::string& reason);

  std::filesystem::path folder_;
  std::array<int, kFiles> descriptors_{};
  std::mutex mutex_;
  std::condition_variable changed_;
  std::deque<Block> queue_;  // not written
  std::size_t queued_bytes_ = 0;
  std::optional<std::string> failure_;
  bool closed_ = false;
  std::int64_t session_ = -1, offset_ = 0;  // of the next packet; of the capture thread
  std::thread thread_;                      // last: uses all other members
};

}  // namespace stillkite
