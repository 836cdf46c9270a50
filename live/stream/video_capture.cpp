#include "live/stream/video_capture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <opencv2/core.hpp>
#include <utility>

#include "live/clock/local_clock.hpp"
#include "live/stream/stream_address.hpp"

namespace stillkite {
namespace {

// A new connection starts with a burst of older images, and the smallest delay is not known yet.
constexpr double kSettle_s = 0.5;
constexpr double kFirstPause_s = 0.1, kMaxPause_s = 1;
constexpr AVRational kNanoseconds{1, 1'000'000'000};

}  // namespace

struct VideoCapture::Session {
  PacketDecoder decoder;
  AVRational time_base;
  bool has_time_stamps;
  ClockMap clock;
  StampFilter arrivals = StampFilter();  // of bare streams
  std::optional<Timestamp> first_arrival;

  FilteredStamp stamp_of(const AVFrame& image, Timestamp arrival) {
    const std::int64_t coded = image.best_effort_timestamp;
    if (!has_time_stamps || coded == AV_NOPTS_VALUE) return arrivals.next(arrival);
    return clock.map(av_rescale_q(coded, time_base, kNanoseconds), arrival);
  }
};

VideoCapture::VideoCapture(const StreamConfig& config, GreyOf grey_of, Report report,
                           FlightRecord* record)
    : config_(config), grey_of_(std::move(grey_of)), report_(std::move(report)), record_(record) {
  const StreamAddress address = parse_stream_address(config.path);
  name_ = address.name;
  reopens_ = address.kind != StreamKind::standard_input;
  thread_ = std::thread([this] { capture_all(); });
}

VideoCapture::~VideoCapture() {
  stop_ = true;
  thread_.join();
}

CaptureCounts VideoCapture::counts() const {
  return {.decoded = decoded_, .replaced = replaced_, .rejected = rejected_, .sessions = sessions_};
}

void VideoCapture::capture_all() {
  double pause_s = kFirstPause_s;
  std::string last_problem;
  report_(fmt::format("video: opening {}", name_));
  while (!stop_) {
    std::string problem;
    try {
      VideoStream stream(config_, stop_);
      ++sessions_;
      report_(fmt::format("video: {} connected: {} {}x{}", name_,
                          avcodec_get_name(stream.codec().codec_id), stream.codec().width,
                          stream.codec().height));
      last_problem.clear();
      pause_s = kFirstPause_s;
      capture_session(stream);
      problem = reopens_ ? "connection lost" : "end of input";
    } catch (const AccessError& error) {
      problem = error.what();
      // more attempts would lock the account; after a connection the cause is another
      if (sessions_ == 0) {
        failure_ = std::make_exception_ptr(InputError(fmt::format("{}: {}", name_, problem)));
        break;
      }
    } catch (const StreamError& error) {
      problem = error.what();
    } catch (...) {
      failure_ = std::current_exception();
      break;
    }
    if (stop_) break;
    if (problem != last_problem) {
      report_(fmt::format("video: {}: {}{}", name_, problem, reopens_ ? "; opening it again" : ""));
    }
    last_problem = problem;
    if (!reopens_) break;
    pause(pause_s);
    pause_s = std::min(2 * pause_s, kMaxPause_s);
  }
  newest_.close();
}

void VideoCapture::capture_session(VideoStream& stream) {
  Session session{.decoder = PacketDecoder(stream.codec()),
                  .time_base = stream.time_base(),
                  .has_time_stamps = stream.has_time_stamps()};
  if (record_ != nullptr) record_->begin_session(stream.codec(), stream.time_base());
  const LibavHandle<AVPacket> packet(av_packet_alloc());
  while (!stop_) {
    const StreamStatus status = stream.read(*packet);
    if (status == StreamStatus::silent && !stop_) {
      report_(fmt::format("video: {}: no packet for {:.3g} s", name_, config_.timeout_s));
    }
    if (status != StreamStatus::packet) return;
    const Timestamp arrival = local_now();
    if (!session.first_arrival) session.first_arrival = arrival;
    av_packet_free_side_data(packet.get());  // not in the record
    if (record_ != nullptr) record_->add_packet(*packet, arrival);
    session.decoder.send(*packet);
    av_packet_unref(packet.get());
    while (const AVFrame* image = session.decoder.receive()) {
      deliver(session, *image, session.decoder.is_damaged(), arrival);
    }
  }
}

void VideoCapture::deliver(Session& session, const AVFrame& image, bool is_damaged,
                           Timestamp arrival) {
  const std::int64_t index = decoded_++;
  FilteredStamp stamp = session.stamp_of(image, arrival);
  stamp.stamp.ns -= std::llround(1e9 * config_.latency_s);
  if (is_damaged) return reject(index, FrameOutcome::damaged, stamp);
  if (seconds_between(*session.first_arrival, arrival) < kSettle_s) {
    return reject(index, FrameOutcome::settling, stamp);
  }
  if (last_stamp_ && stamp.stamp <= *last_stamp_) {
    return reject(index, FrameOutcome::out_of_order, stamp);
  }
  const cv::Size size(image.width, image.height);
  if (size_.area() == 0) size_ = size;
  if (size != size_) {
    if (!std::exchange(has_reported_size_, true)) {
      report_(fmt::format("video: {}: images of {}x{} are rejected; the calibration is for {}x{}",
                          name_, size.width, size.height, size_.width, size_.height));
    }
    return reject(index, FrameOutcome::resized, stamp);
  }
  cv::Mat grey = grey_of_(image, pool_.take());
  if (grey.empty()) return reject(index, FrameOutcome::damaged, stamp);
  pool_.keep(grey);
  last_stamp_ = stamp.stamp;
  const std::optional<CapturedFrame> replaced =
      newest_.put({.frame = {.stamp = stamp.stamp,
                             .index = index,
                             .grey = std::move(grey),
                             .stamp_sigma_s = stamp.sigma_s,
                             .recorded_stamp = stamp.stamp},
                   .arrival = arrival});
  if (!replaced) return;
  ++replaced_;
  if (record_ == nullptr) return;
  record_->add_frame({.index = replaced->frame.index,
                      .outcome = FrameOutcome::replaced,
                      .stamp = replaced->frame.stamp,
                      .stamp_sigma_s = replaced->frame.stamp_sigma_s});
}

void VideoCapture::reject(std::int64_t index, FrameOutcome outcome, const FilteredStamp& stamp) {
  ++rejected_;
  if (record_ == nullptr) return;
  record_->add_frame(
      {.index = index, .outcome = outcome, .stamp = stamp.stamp, .stamp_sigma_s = stamp.sigma_s});
}

void VideoCapture::pause(double pause_s) const {
  constexpr double kStep_s = 0.05;
  for (double waited_s = 0; waited_s < pause_s && !stop_; waited_s += kStep_s) {
    std::this_thread::sleep_for(std::chrono::duration<double>(kStep_s));
  }
}

}  // namespace stillkite
