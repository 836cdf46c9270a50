#include "live/stream/video_stream.hpp"

extern "C" {
#include <libavdevice/avdevice.h>
#include <libavutil/opt.h>
}

#include <dlfcn.h>
#include <fmt/format.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cmath>
#include <limits>
#include <string_view>
#include <thread>

#include "geometry/fields.hpp"

namespace stillkite {
namespace {

constexpr double kProbe_s = 5;  // for the first key frame
constexpr int kPoll_ms = 50;

// Loads libavdevice, which only cameras need: it depends on 50 more Debian packages, and loading
// them takes half of the start of a command. Throws AccessError without it.
void register_devices() {
  const std::string name = fmt::format("libavdevice.so.{}", LIBAVDEVICE_VERSION_MAJOR);
  void* library = dlopen(name.c_str(), RTLD_NOW);  // never closed
  void* function = library != nullptr ? dlsym(library, "avdevice_register_all") : nullptr;
  if (function == nullptr) {
    throw AccessError(fmt::format("cameras need {}; install it: apt install libavdevice{}", name,
                                  LIBAVDEVICE_VERSION_MAJOR));
  }
  reinterpret_cast<decltype(&avdevice_register_all)>(function)();
}

// Cause and, where libav's text is not enough, remedy.
std::string error_text(int error) {
  switch (error) {
    case AVERROR(EIO):
      return "no connection; check host, port and network";
    case AVERROR_EXIT:
      return "no video in time; check that the sender runs";
    case AVERROR_INVALIDDATA:
      return "no video of a known format";
    default:
      break;
  }
  std::array<char, AV_ERROR_MAX_STRING_SIZE> text{};
  av_strerror(error, text.data(), text.size());
  return text.data();
}

// Options of libavformat. Those that a protocol does not have are ignored.
class Options {
 public:
  Options() = default;
  Options(const Options&) = delete;
  Options& operator=(const Options&) = delete;
  ~Options() { av_dict_free(&entries_); }

  void set(const char* key, const std::string& value) {
    av_dict_set(&entries_, key, value.c_str(), 0);
  }
  [[nodiscard]] AVDictionary** get() { return &entries_; }

 private:
  AVDictionary* entries_ = nullptr;
};

void set_options(Options& options, const StreamConfig& config, StreamKind kind) {
  options.set("protocol_whitelist", "file,udp,rtp,rtsp,tcp,crypto");
  options.set("analyzeduration", fmt::format("{}", std::llround(1e6 * kProbe_s)));
  options.set("fpsprobesize", "0");
  options.set("max_ts_probe", "0");
  if (kind == StreamKind::rtsp)
    options.set("rtsp_transport", std::string(name_of(config.transport)));
  if (kind == StreamKind::udp) {
    options.set("overrun_nonfatal", "1");
    options.set("fifo_size", "50000");  // packets of 188 bytes
  }
  constexpr int kMaxReordering_us = 50'000;
  if (kind == StreamKind::rtp || kind == StreamKind::sdp || kind == StreamKind::rtsp) {
    options.set("max_delay", fmt::format("{}", kMaxReordering_us));
  }
}

bool invents_time_stamps(const AVFormatContext& container) {
  const AVClass* options = container.iformat->priv_class;
  return options != nullptr &&
         av_opt_find(&options, "framerate", nullptr, 0, AV_OPT_SEARCH_FAKE_OBJ) != nullptr;
}

// True if a packet of the demuxer is one image. Those of RTP are parts of images, and a bare stream
// has none: the parser joins and splits them, and delays an image until the next one begins.
bool holds_whole_images(const AVFormatContext& container) {
  const std::string_view format = container.iformat->name;
  return format == "mpegts" || format.starts_with("video4linux2");
}

}  // namespace

VideoStream::VideoStream(const StreamConfig& config, const std::atomic<bool>& stop)
    : config_(config), stop_(stop) {
  silence_libav();
  const StreamAddress address = parse_stream_address(config.path);
  set_deadline(config.timeout_s + kProbe_s);
  open(address);
  has_time_stamps_ = address.kind == StreamKind::device || !invents_time_stamps(*container_);
  if (holds_whole_images(*container_)) {
    container_->flags |= AVFMT_FLAG_NOPARSE | AVFMT_FLAG_NOFILLIN;
  }
  if (const int error = avformat_find_stream_info(container_.get(), nullptr); error < 0) {
    throw StreamError(error_text(error));
  }
  const int index = av_find_best_stream(container_.get(), AVMEDIA_TYPE_VIDEO, -1, -1, nullptr, 0);
  if (index < 0) throw StreamError("no video");
  stream_ = container_->streams[index];
  if (stream_->codecpar->width <= 0) throw StreamError("no key frame");
  key_frames_.emplace(*stream_->codecpar);
  for (unsigned i = 0; i < container_->nb_streams; ++i) {
    if (static_cast<int>(i) != index) container_->streams[i]->discard = AVDISCARD_ALL;
  }
}

VideoStream::~VideoStream() = default;

void VideoStream::open(const StreamAddress& address) {
  AVFormatContext* context = avformat_alloc_context();
  if (context == nullptr) throw std::bad_alloc();
  context->interrupt_callback = {.callback = is_over, .opaque = this};
  const AVInputFormat* format = nullptr;
  if (address.kind == StreamKind::standard_input) {
    constexpr int kBlock_bytes = 1 << 12;
    input_.reset(avio_alloc_context(static_cast<unsigned char*>(av_malloc(kBlock_bytes)),
                                    kBlock_bytes, 0, this, read_standard_input, nullptr, nullptr));
    context->pb = input_.get();
  } else if (address.kind == StreamKind::device) {
    register_devices();
    context->flags |= AVFMT_FLAG_NONBLOCK;  // a read that waits for an image cannot be interrupted
    format = av_find_input_format("v4l2");
  } else if (address.kind == StreamKind::udp) {
    format = av_find_input_format("mpegts");
  }
  Options options;
  set_options(options, config_, address.kind);
  const std::string url = address.kind == StreamKind::standard_input ? "" : address.url;
  const int error = avformat_open_input(&context, url.c_str(), format, options.get());
  // the context is freed
  if (error == AVERROR_HTTP_UNAUTHORIZED || error == AVERROR_HTTP_FORBIDDEN) {
    throw AccessError(error_text(error) + "; check user and password in source.path");
  }
  if (error < 0) throw StreamError(error_text(error));
  container_.reset(context);
}

StreamStatus VideoStream::read(AVPacket& packet) {
  set_deadline(config_.timeout_s);
  while (true) {
    const int error = av_read_frame(container_.get(), &packet);
    // after the time-out the last packets of the parser are returned before the error
    is_silent_ = is_silent_ || is_over(this) != 0;
    if (error >= 0 && packet.stream_index == stream_->index) {
      key_frames_->mark(packet);
      return StreamStatus::packet;
    }
    if (error >= 0) {
      av_packet_unref(&packet);
    } else if (is_silent_) {
      return StreamStatus::silent;
    } else if (error == AVERROR(EAGAIN)) {
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    } else {
      return StreamStatus::ended;
    }
  }
}

// A pause of standard input is no end: it cannot be opened again.
void VideoStream::set_deadline(double wait_s) {
  deadline_ns_ = config_.path == "-"
                     ? std::numeric_limits<std::int64_t>::max()
                     : Clock::now().time_since_epoch().count() + std::llround(1e9 * wait_s);
}

int VideoStream::is_over(void* self) {
  const auto& stream = *static_cast<const VideoStream*>(self);
  return stream.stop_ || Clock::now().time_since_epoch().count() > stream.deadline_ns_ ? 1 : 0;
}

// A blocking read() of a pipe cannot be interrupted.
int VideoStream::read_standard_input(void* self, std::uint8_t* data, int size) {
  while (is_over(self) == 0) {
    pollfd ready{.fd = STDIN_FILENO, .events = POLLIN, .revents = 0};
    if (poll(&ready, 1, kPoll_ms) <= 0) continue;
    const ssize_t bytes = ::read(STDIN_FILENO, data, static_cast<std::size_t>(size));
    if (bytes > 0) return static_cast<int>(bytes);
    if (bytes == 0) return AVERROR_EOF;
    if (errno != EINTR && errno != EAGAIN) return AVERROR(errno);
  }
  return AVERROR_EXIT;
}

}  // namespace stillkite
