// Decodes a video with OpenCV and prints the frame count: baseline of bench/run_rate.py.
#include <fmt/core.h>

#include <cstdlib>
#include <opencv2/core/mat.hpp>
#include <opencv2/videoio.hpp>

int main(int argc, char** argv) {
  if (argc != 2) {
    fmt::print(stderr, "usage: bench_opencv_decoding VIDEO\n");
    return 2;
  }
  cv::VideoCapture video(argv[1], cv::CAP_FFMPEG);
  if (!video.isOpened()) {
    fmt::print(stderr,
               "bench_opencv_decoding: {}: not a readable video; give a file that FFmpeg decodes\n",
               argv[1]);
    return 2;
  }
  cv::Mat frame;
  int frames = 0;
  while (video.read(frame)) ++frames;
  fmt::print("{}\n", frames);
  return frames > 0 ? EXIT_SUCCESS : EXIT_FAILURE;
}
