#include "io/video/frame_source.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <deque>
#include <exception>
#include <thread>
#include <variant>

#include "flow/image_pool.hpp"
#include "geometry/stamp_filter.hpp"
#include "io/dataset/euroc_dataset.hpp"
#include "io/dataset/image_folder.hpp"
#include "io/text_file.hpp"
#include "io/video/bounded_queue.hpp"
#include "io/video/image_sequence.hpp"
#include "io/video/video_reader.hpp"

namespace stillkite {
namespace fs = std::filesystem;
namespace {

// Hides the jitter of a multi-threaded decoder.
constexpr std::size_t kDecodeAhead = 4;
constexpr std::size_t kFollowing = 8;  // frames whose stamps StampFilter compares

using Reader = std::variant<VideoReader, ImageSequence>;

std::vector<StampedImage> images_between(std::vector<StampedImage> images,
                                         const SourceConfig& config) {
  const Timestamp first = images.front().stamp;
  std::erase_if(images, [&](const StampedImage& image) {
    const double t_s = seconds_between(first, image.stamp);
    return t_s < config.start_s || (config.end_s && t_s > *config.end_s);
  });
  return images;
}

Reader open_reader(const SourceConfig& config) {
  const fs::path& path = config.path;
  if (path.empty()) {
    throw InputError(
        "source.path is not set; set it to a video, a EuRoC data set or a folder of "
        "images");
  }
  if (config.end_s && *config.end_s <= config.start_s) {
    throw InputError(fmt::format("source.end_s {} must be greater than source.start_s {}",
                                 *config.end_s, config.start_s));
  }
  if (!fs::exists(path)) {
    throw InputError(path.string() + ": no such file or folder; check source.path");
  }
  if (is_special_file(path)) {
    throw InputError(path.string() + ": is a pipe or a device, expected a file or a folder");
  }
  if (!fs::is_directory(path)) {
    if (fs::is_regular_file(path) && fs::file_size(path) == 0) {
      throw InputError(path.string() + ": the file is empty");
    }
    if (is_image(path)) {
      throw InputError(path.string() +
                       ": a single image; set source.path to the folder of the images, or convert "
                       "animated images and pages to a video");
    }
    return VideoReader(config);
  }
  if (config.track) throw InputError("source.track: only for videos; remove it for a folder");
  if (const auto dataset = find_euroc_dataset(path)) {
    std::vector<StampedImage> listed = read_image_list(dataset->images_csv, config.rate_hz);
    return ImageSequence(images_between(std::move(listed), config), config.bits);
  }
  std::vector<StampedImage> images = list_images(path, config.rate_hz);
  return ImageSequence(images_between(std::move(images), config), config.bits);
}

std::optional<std::int64_t> expected_frames(const Reader& reader, const SourceConfig& config) {
  if (const auto* images = std::get_if<ImageSequence>(&reader))
    return static_cast<std::int64_t>(images->count());
  const auto& video = std::get<VideoReader>(reader);
  const std::optional<double> rate = video.frames_per_s();
  std::optional<double> end_s = video.duration_s();
  if (config.end_s && (!end_s || *config.end_s < *end_s)) end_s = config.end_s;
  if (!rate || !end_s) return std::nullopt;
  return std::max<std::int64_t>(0, std::llround((*end_s - config.start_s) * *rate));
}

StampFilter stamp_filter_for(const Reader& reader) {
  if (const auto* video = std::get_if<VideoReader>(&reader)) {
    return StampFilter(video->stamp_resolution_s());
  }
  StampFilter filter;
  filter.initialize(std::get<ImageSequence>(reader).stamps());
  return filter;
}

// Message if the jitter exceeds one percent of the interval and the container's rounding.
std::optional<std::string> jitter_note(const StampFilter& stamps) {
  constexpr double kMinRatio = 0.01;
  const double ratio = std::sqrt(2.0) * stamps.jitter_s() / stamps.period_s();
  if (!(ratio > kMinRatio) || stamps.jitter_s() < stamps.resolution_s()) return std::nullopt;
  return fmt::format(
      ": the time stamps jitter by {:.2g} ms, which changes frame intervals by {:.2g} %; they are "
      "smoothed",
      1e3 * stamps.jitter_s(), 100 * ratio);
}

// Message if more frames came in bursts than at a change of the frame rate, which flags three.
std::optional<std::string> burst_note(const StampFilter& stamps, std::int64_t images) {
  constexpr int kMaxAtRateChange = 3;
  if (stamps.burst_stamps() <= kMaxAtRateChange) return std::nullopt;
  return fmt::format(
      ": {} of {} images came in bursts, stamped on arrival; their stamps are replaced by the mean "
      "frame interval, or have its error; use stamps of exposure, or set source.rate_hz",
      stamps.burst_stamps(), images);
}

}  // namespace

struct FrameSource::State {
  explicit State(const SourceConfig& source)
      : config(source),
        reader(open_reader(source)),
        expected(expected_frames(reader, source)),
        stamps(stamp_filter_for(reader)) {}
  ~State() {
    queue.close();
    if (thread.joinable()) thread.join();
  }

  void decode_all();
  std::optional<ReadResult> pop();
  [[nodiscard]] std::vector<Timestamp> following() const;
  std::optional<Frame> take();

  SourceConfig config;
  Reader reader;  // owned by the decoding thread until the queue is closed
  std::optional<std::int64_t> expected;
  BoundedQueue<ReadResult> queue{kDecodeAhead};
  // failure, reader_ended: written before, read after the queue is closed
  std::exception_ptr failure;
  bool reader_ended = false;
  std::atomic<std::int64_t> decoding_ns = 0;

  std::optional<Frame> first;
  bool first_returned = false;
  std::optional<Timestamp> last_stamp;  // as stored
  StampFilter stamps;
  std::deque<ReadResult> ahead;  // popped from the queue
  std::int64_t read = 0;
  std::int64_t undecodable = 0;
  std::int64_t out_of_order = 0;  // time stamps that do not increase
  bool interlaced = false;
  bool at_end = false;
  std::thread thread;  // last: uses all other members
};

void FrameSource::State::decode_all() {
  const bool is_video = std::holds_alternative<VideoReader>(reader);
  ImagePool pool;
  try {
    while (true) {
      const auto start = std::chrono::steady_clock::now();
      ReadResult result = std::visit([&](auto& from) { return from.read(pool.take()); }, reader);
      decoding_ns += std::chrono::nanoseconds(std::chrono::steady_clock::now() - start).count();
      if (result.status == ReadResult::Status::end) {
        reader_ended = true;
        break;
      }
      if (result.status == ReadResult::Status::frame) {
        if (is_video && config.end_s && to_seconds(result.frame.stamp) > *config.end_s) break;
        pool.keep(result.frame.grey);
      }
      if (!queue.push(std::move(result))) break;
    }
  } catch (...) {
    failure = std::current_exception();
  }
  queue.close();
}

std::optional<ReadResult> FrameSource::State::pop() {
  while (ahead.size() <= kFollowing) {
    std::optional<ReadResult> result = queue.pop();
    if (!result) break;
    ahead.push_back(std::move(*result));
  }
  if (ahead.empty()) return std::nullopt;
  ReadResult result = std::move(ahead.front());
  ahead.pop_front();
  return result;
}

// Ascending stamps of the frames after the last one popped.
std::vector<Timestamp> FrameSource::State::following() const {
  std::vector<Timestamp> out;
  Timestamp last = *last_stamp;
  for (const ReadResult& result : ahead) {
    if (result.status != ReadResult::Status::frame || result.frame.stamp <= last) continue;
    last = result.frame.stamp;
    out.push_back(last);
  }
  return out;
}

std::optional<Frame> FrameSource::State::take() {
  while (std::optional<ReadResult> result = pop()) {
    const std::int64_t index = read++;
    if (result->status == ReadResult::Status::undecodable) {
      ++undecodable;
      continue;
    }
    if (last_stamp && result->frame.stamp <= *last_stamp) {
      ++out_of_order;
      continue;
    }
    interlaced = interlaced || result->interlaced;
    last_stamp = result->frame.stamp;
    const FilteredStamp filtered = stamps.next(result->frame.stamp, following());
    result->frame.recorded_stamp = result->frame.stamp;
    result->frame.stamp = filtered.stamp;
    result->frame.stamp_sigma_s = filtered.sigma_s;
    result->frame.index = index;
    return std::move(result->frame);
  }
  at_end = true;
  if (failure) std::rethrow_exception(std::exchange(failure, nullptr));
  return std::nullopt;
}

FrameSource::FrameSource(const SourceConfig& config) : state_(std::make_unique<State>(config)) {
  State& s = *state_;
  s.thread = std::thread([&s] { s.decode_all(); });
  s.first = s.take();
  if (!s.first) {
    const bool is_cut = config.start_s > 0 || config.end_s.has_value();
    throw InputError(config.path.string() +
                     (s.read == 0 && is_cut ? ": no image between source.start_s and source.end_s"
                                            : ": no image can be decoded; the file is damaged"));
  }
}

FrameSource::~FrameSource() = default;
FrameSource::FrameSource(FrameSource&&) noexcept = default;
FrameSource& FrameSource::operator=(FrameSource&&) noexcept = default;

const Frame& FrameSource::first() const {
  return *state_->first;
}

std::optional<Frame> FrameSource::next() {
  if (std::exchange(state_->first_returned, true)) return state_->take();
  return state_->first;
}

std::int64_t FrameSource::read() const {
  return state_->read;
}
std::int64_t FrameSource::rejected() const {
  return state_->undecodable + state_->out_of_order;
}
double FrameSource::decoding_s() const {
  return 1e-9 * static_cast<double>(state_->decoding_ns);
}
std::optional<std::int64_t> FrameSource::expected() const {
  return state_->expected;
}

bool FrameSource::is_rotated() const {
  return std::visit([](const auto& reader) { return reader.is_rotated(); }, state_->reader);
}

std::optional<std::string> FrameSource::problem() const {
  const State& s = *state_;
  std::string found;
  const auto add = [&](const std::string& sentence) {
    found += (found.empty() ? "" : "; ") + sentence;
  };
  const auto* video = std::get_if<VideoReader>(&s.reader);
  if (video != nullptr) std::ranges::for_each(video->notes(), add);
  // the decoding thread owns the reader until the end
  if (s.at_end && s.reader_ended && video != nullptr) {
    if (const std::optional<std::string> truncation = video->truncation()) add(*truncation);
  }
  const std::string path = s.config.path.string();
  if (s.interlaced) {
    add(
        fmt::format("{}: interlaced; of each image the first field is used and its lines are "
                    "interpolated",
                    path));
  }
  if (s.undecodable > 0) {
    add(fmt::format(
        "{}: {} of {} images cannot be decoded and are skipped{}", path, s.undecodable, s.read,
        video == nullptr ? ""
                         : " (images predicted from them are damaged, so the covariance "
                           "is optimistic there)"));
  }
  if (const std::optional<std::string> jitter = jitter_note(s.stamps)) add(path + *jitter);
  if (const std::optional<std::string> bursts = burst_note(s.stamps, s.read)) add(path + *bursts);
  if (s.out_of_order > 0) {
    add(
        fmt::format("{}: {} of {} images have time stamps that do not increase and are skipped; "
                    "source.rate_hz stamps all images by counting",
                    path, s.out_of_order, s.read));
  }
  return found.empty() ? std::nullopt : std::optional(found);
}

}  // namespace stillkite
