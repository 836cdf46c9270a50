#include "live/record/flight_record.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <utility>

namespace stillkite {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMaxQueued_bytes = 64 << 20;
constexpr std::array kNames{kSessionsFile,  kPacketsFile,   kVideoFile,   kFramesFile,
                            kTelemetryFile, kEstimatesFile, kCommandsFile};

int create(const fs::path& file) {
  const int descriptor =
      open(file.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_APPEND | O_CLOEXEC, 0666);
  if (descriptor >= 0) return descriptor;
  throw InputError(fmt::format("{}: cannot be created: {}; choose another folder with --out",
                               file.string(), std::strerror(errno)));
}

}  // namespace

FlightRecord::FlightRecord(const fs::path& folder) : folder_(folder) {
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (!failure && !fs::is_empty(folder, failure) && !failure) {
    throw InputError(folder.string() +
                     ": has files already; choose a new folder for the record with --out");
  }
  if (failure) {
    throw InputError(fmt::format("{}: cannot be created: {}; choose another folder with --out",
                                 folder.string(), failure.message()));
  }
  descriptors_.fill(-1);
  for (std::size_t i = 0; i < commands; ++i) descriptors_[i] = create(folder / kNames[i]);
  append(sessions, sessions_header());
  append(packets, packets_header());
  append(frames, frames_header());
  append(telemetry, telemetry_header());
  thread_ = std::thread([this] { write_all(); });
}

FlightRecord::~FlightRecord() {
  {
    const std::lock_guard lock(mutex_);
    closed_ = true;
    changed_.notify_one();
  }
  thread_.join();
  for (const int descriptor : descriptors_) {
    if (descriptor >= 0) close(descriptor);
  }
}

void FlightRecord::begin_session(const AVCodecParameters& codec, AVRational time_base) {
  ++session_;
  append(sessions, session_row(codec, time_base));
}

void FlightRecord::add_packet(const AVPacket& packet, Timestamp arrival) {
  const RecordedPacket row{.session = session_,
                           .offset = offset_,
                           .size = packet.size,
                           .flags = packet.flags,
                           .pts = packet.pts,
                           .dts = packet.dts,
                           .arrival = arrival};
  offset_ += packet.size;
  append(video, std::string(packet.data, packet.data + packet.size));
  append(packets, packet_row(row));
}

void FlightRecord::add_frame(const RecordedFrame& frame) {
  append(frames, frame_row(frame));
}

void FlightRecord::add_message(const RecordedMessage& message) {
  append(telemetry, message_row(message));
}

void FlightRecord::add_estimate(const std::string& row) {
  append(estimates, row);
}

void FlightRecord::add_command(const std::string& row) {
  if (descriptors_[commands] < 0) descriptors_[commands] = create(folder_ / kNames[commands]);
  append(commands, row);
}

std::optional<std::string> FlightRecord::failure() {
  const std::lock_guard lock(mutex_);
  return failure_;
}

void FlightRecord::append(File file, std::string bytes) {
  const std::lock_guard lock(mutex_);
  if (failure_) return;
  queued_bytes_ += bytes.size();
  if (queued_bytes_ > kMaxQueued_bytes) {
    failure_ = folder_.string() + ": the disk is too slow; the record ends";
    return;
  }
  queue_.push_back({file, std::move(bytes)});
  changed_.notify_one();
}

void FlightRecord::write_all() {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds kSyncInterval{1};
  Clock::time_point synced = Clock::now();
  while (true) {
    std::deque<Block> blocks;
    {
      std::unique_lock lock(mutex_);
      changed_.wait_for(lock, kSyncInterval, [this] { return closed_ || !queue_.empty(); });
      if (closed_ && queue_.empty()) return;
      blocks.swap(queue_);
    }
    for (const Block& block : blocks) write(block);
    if (Clock::now() - synced < kSyncInterval) continue;
    for (const int descriptor : descriptors_) {
      if (descriptor >= 0) fdatasync(descriptor);
    }
    synced = Clock::now();
  }
}

void FlightRecord::write(const Block& block) {
  if (failure()) return;
  std::size_t done = 0;
  while (done < block.bytes.size()) {
    const ssize_t n =
        ::write(descriptors_[block.file], block.bytes.data() + done, block.bytes.size() - done);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return fail(std::strerror(n < 0 ? errno : ENOSPC));
    done += static_cast<std::size_t>(n);
  }
  const std::lock_guard lock(mutex_);
  queued_bytes_ -= block.bytes.size();
}

void FlightRecord::fail(const std::string& reason) {
  const std::lock_guard lock(mutex_);
  failure_ = fmt::format("{}: cannot be written: {}; the record ends", folder_.string(), reason);
}

}  // namespace stillkite
