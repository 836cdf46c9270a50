#include "live/record/flight_replay.hpp"

#include <algorithm>
#include <utility>

namespace stillkite {

FlightReplay::FlightReplay(const std::filesystem::path& folder, GreyOf grey_of)
    : grey_of_(std::move(grey_of)),
      sessions_(read_sessions(folder)),
      packets_(read_packets(folder)),
      frames_(read_frames(folder)),
      messages_(read_messages(folder)),
      video_(folder / kVideoFile, std::ios::binary) {
  select_used_frames();
  if (!video_) throw InputError((folder / kVideoFile).string() + ": cannot be read");
  for (const RecordedPacket& packet : packets_) {
    const bool has_session =
        packet.session >= 0 && packet.session < static_cast<std::int64_t>(sessions_.size());
    if (has_session && packet.offset >= 0 && packet.size >= 0) continue;
    throw InputError((folder / kPacketsFile).string() + ": a packet has no session or no data");
  }
}

// Rows of replaced and used images are written by two threads: not in the order of their index.
void FlightReplay::select_used_frames() {
  std::ranges::stable_sort(frames_, {}, &RecordedFrame::index);
  std::vector<RecordedFrame> used;
  CaptureCounts counts;
  for (const RecordedFrame& frame : std::exchange(frames_, {})) {
    counts.decoded = frame.index + 1;
    if (frame.outcome == FrameOutcome::used) {
      used.push_back(frame);
      counts_.push_back(counts);
    } else {
      ++(frame.outcome == FrameOutcome::replaced ? counts.replaced : counts.rejected);
    }
  }
  frames_ = std::move(used);
}

std::optional<ReplayedFrame> FlightReplay::next() {
  if (next_frame_ == frames_.size()) return std::nullopt;
  const CaptureCounts& images = counts_[next_frame_];
  const RecordedFrame& row = frames_[next_frame_++];
  while (const AVFrame* image = decode_next()) {
    if (decoded_++ < row.index) continue;
    cv::Mat grey = grey_of_(*image, pool_.take());
    if (grey.empty()) return std::nullopt;
    pool_.keep(grey);
    return ReplayedFrame{.frame = {.stamp = row.stamp,
                                   .index = row.index,
                                   .grey = std::move(grey),
                                   .stamp_sigma_s = row.stamp_sigma_s,
                                   .recorded_stamp = row.stamp},
                         .decision = row.decision,
                         .images = images,
                         .telemetry = messages_until(row.telemetry)};
  }
  return std::nullopt;
}

const AVFrame* FlightReplay::decode_next() {
  while (true) {
    if (decoder_) {
      if (const AVFrame* image = decoder_->receive()) return image;
    }
    if (!send_packet()) return nullptr;
  }
}

bool FlightReplay::send_packet() {
  if (next_packet_ == packets_.size()) return false;
  const RecordedPacket& row = packets_[next_packet_++];
  if (row.session != session_) {
    session_ = row.session;
    decoder_.emplace(*sessions_[static_cast<std::size_t>(session_)].codec);
  }
  av_packet_unref(packet_.get());
  if (row.size > INT32_MAX || av_new_packet(packet_.get(), static_cast<int>(row.size)) < 0) {
    return false;
  }
  video_.seekg(row.offset);
  video_.read(reinterpret_cast<char*>(packet_->data), row.size);
  if (video_.gcount() != row.size) return false;  // the process was killed while it wrote
  packet_->flags = static_cast<int>(row.flags);
  packet_->pts = row.pts;
  packet_->dts = row.dts;
  decoder_->send(*packet_);
  return true;
}

std::vector<RecordedMessage> FlightReplay::messages_until(std::int64_t count) {
  const std::size_t end = std::clamp(static_cast<std::size_t>(std::max<std::int64_t>(count, 0)),
                                     next_message_, messages_.size());
  std::vector<RecordedMessage> out(
      std::make_move_iterator(messages_.begin() + std::ptrdiff_t(next_message_)),
      std::make_move_iterator(messages_.begin() + std::ptrdiff_t(end)));
  next_message_ = end;
  return out;
}

}  // namespace stillkite
