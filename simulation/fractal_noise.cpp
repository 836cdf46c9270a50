#include "simulation/fractal_noise.hpp"

#include <opencv2/imgproc.hpp>

namespace stillkite {

cv::Mat lattice_noise(int width, int height, int cell, const Random& start) {
  Random random = start;
  cv::Mat lattice(height / cell + 4, width / cell + 4, CV_32FC1);
  for (int row = 0; row < lattice.rows; ++row) {
    for (int column = 0; column < lattice.cols; ++column) {
      lattice.at<float>(row, column) = static_cast<float>(random.uniform(-1.0, 1.0));
    }
  }
  cv::Mat fine;
  cv::resize(lattice, fine, lattice.size() * cell, 0, 0, cv::INTER_CUBIC);
  return fine(cv::Rect(cell, cell, width, height)).clone();
}

cv::Mat fractal_noise(int width, int height, std::uint64_t seed) {
  cv::Mat sum(height, width, CV_32FC1, cv::Scalar(0));
  for (int cell = 2, level = 1; cell <= 512; cell *= 2, ++level) {
    const double fine_is_weaker = cell == 2 ? 0.7 : 1.0;
    cv::scaleAdd(lattice_noise(width, height, cell, Random(seed, level)), fine_is_weaker, sum, sum);
  }
  return sum;
}

}  // namespace stillkite
