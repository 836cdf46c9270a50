#include "io/video/video_decoder.hpp"

#include <algorithm>
#include <string_view>
#include <utility>

namespace stillkite {
namespace {

constexpr AVRational kNanoseconds{1, 1'000'000'000};

std::int64_t first_stamp(const AVStream& stream) {
  return stream.start_time == AV_NOPTS_VALUE ? 0 : stream.start_time;
}

}  // namespace

VideoDecoder::VideoDecoder(const std::string& file, std::optional<int> track)
    : file_(file), number_(track), track_(open_video_track(file, track)) {}

ReadResult::Status VideoDecoder::next() {
  using Status = ReadResult::Status;
  if (std::exchange(peeked_, false)) return Status::frame;
  while (true) {
    const int status = avcodec_receive_frame(track_.decoder.get(), image_.get());
    if (status >= 0) return Status::frame;
    // after the last packet a failing decoder never returns AVERROR_EOF
    if (status == AVERROR_EOF || (status != AVERROR(EAGAIN) && sent_all_)) return Status::end;
    if (status != AVERROR(EAGAIN) || !send_packet()) return Status::undecodable;
  }
}

bool VideoDecoder::peek() {
  ReadResult::Status status = next();
  while (status == ReadResult::Status::undecodable) status = next();
  peeked_ = status == ReadResult::Status::frame;
  return peeked_;
}

// Formats without an index of key frames are searched by time stamps, and the next key frame may be
// after the start. So the position is verified by the first image, else moved back.
void VideoDecoder::seek(Timestamp start) {
  // MPEG-PS stamps some images only; stamps of the others count from the beginning of the file
  if (std::string_view(track_.container->iformat->name) == "mpeg") return;
  const AVStream& stream = *track_.stream;
  constexpr std::int64_t kFirstStep_ns = 1'000'000'000;
  for (std::int64_t back_ns = 0; back_ns < start.ns;
       back_ns = std::max(kFirstStep_ns, 3 * back_ns)) {
    const std::int64_t target =
        first_stamp(stream) + av_rescale_q(start.ns - back_ns, kNanoseconds, stream.time_base);
    reset();
    if (av_seek_frame(track_.container.get(), stream.index, target, AVSEEK_FLAG_BACKWARD) < 0)
      break;
    if (peek() && key_ && *key_ <= start && stamp() && *stamp() <= start) return;
  }
  track_ = open_video_track(file_, number_);
  reset();
}

void VideoDecoder::reset() {
  avcodec_flush_buffers(track_.decoder.get());
  awaits_key_ = true;
  peeked_ = sent_all_ = false;
}

// Sends a packet to the decoder; false if it is damaged.
bool VideoDecoder::send_packet() {
  const int status = av_read_frame(track_.container.get(), packet_.get());
  if (status == AVERROR(EAGAIN)) return true;
  if (status < 0) {
    sent_all_ = true;
    avcodec_send_packet(track_.decoder.get(), nullptr);
    return true;
  }
  const bool ours = packet_->stream_index == track_.stream->index;
  if (ours && awaits_key_ && (packet_->flags & AV_PKT_FLAG_KEY) != 0) {
    awaits_key_ = false;
    key_ = stamp_of(packet_->pts);
  }
  const bool sends = ours && !awaits_key_;
  const int sent = sends ? avcodec_send_packet(track_.decoder.get(), packet_.get()) : 0;
  av_packet_unref(packet_.get());
  return sent >= 0;
}

std::optional<Timestamp> VideoDecoder::stamp() const {
  return stamp_of(image_->best_effort_timestamp);
}

std::optional<Timestamp> VideoDecoder::stamp_of(std::int64_t coded) const {
  if (coded == AV_NOPTS_VALUE) return std::nullopt;
  const AVStream& stream = *track_.stream;
  return Timestamp{av_rescale_q(coded - first_stamp(stream), stream.time_base, kNanoseconds)};
}

}  // namespace stillkite
